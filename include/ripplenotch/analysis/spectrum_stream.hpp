// SPDX-License-Identifier: MIT
#pragma once
// torque_spectrum in pieces, of samples that go by and are not held: once for the power, and once more for
// the lines found in it.

#include <memory>
#include <span>

#include "ripplenotch/analysis/spectrum.hpp"

namespace ripplenotch {

class SpectrumStream {
  public:
    /// `length` samples a piece, from piece_length. The rate may be a guess until settle().
    SpectrumStream(std::size_t length, Hertz rate);
    ~SpectrumStream();
    SpectrumStream(SpectrumStream&&) noexcept;
    SpectrumStream& operator=(SpectrumStream&&) noexcept;

    /// First pass: consecutive samples, seconds and Nm, any number at a time. Holds two pieces at most,
    /// besides what was handed over last.
    void add(std::span<const double> time_s, std::span<const double> torque_nm);
    /// The rate is this one. False when the samples might have told otherwise with it: then they have to be
    /// added again, to a new stream.
    [[nodiscard]] bool settle(Hertz rate);
    /// Between the passes. False when there is no line, and so no need of a second pass.
    bool find_lines(double false_alarm);
    /// Second pass, the same samples.
    void measure(std::span<const double> time_s, std::span<const double> torque_nm);

    /// That of torque_spectrum for the same samples, bit for bit.
    [[nodiscard]] Spectrum spectrum() const;

  private:
    struct Work;
    std::unique_ptr<Work> work_;
};

}  // namespace ripplenotch
