// SPDX-License-Identifier: MIT
#pragma once
// The mean spectrum of pieces that go by one after another: once for the power, and once more for the lines
// found in it.

#include <optional>
#include <span>
#include <vector>

#include "analysis/spectrum/line_meter.hpp"
#include "analysis/spectrum/piece.hpp"
#include "ripplenotch/analysis/humps.hpp"
#include "ripplenotch/analysis/line_test.hpp"
#include "ripplenotch/analysis/spectrum.hpp"

namespace ripplenotch {

class Welch {
  public:
    /// `length` samples a piece.
    Welch(std::size_t length, Hertz rate);

    /// First pass: consecutive samples, seconds and Nm. Returns how many are done with: the others are to
    /// come again, in front of those that follow them.
    std::size_t add(std::span<const double> time_s, std::span<const double> torque_nm);
    /// As if the rate had been another one from the beginning; empty where that cannot be said.
    [[nodiscard]] std::optional<Welch> at(Hertz rate) const;
    /// Between the passes. False when there is no line, and so no need of a second pass.
    bool find_lines(double false_alarm);
    /// Second pass, the same samples in the same way.
    std::size_t measure(std::span<const double> time_s, std::span<const double> torque_nm);

    [[nodiscard]] Spectrum spectrum() const;

  private:
    [[nodiscard]] PowerSpectrum tested() const;
    [[nodiscard]] double bin_hz() const { return rate_ / static_cast<double>(length_); }
    [[nodiscard]] SpectralPeak peak(std::size_t line) const;
    [[nodiscard]] std::vector<double> power_without_lines() const;
    [[nodiscard]] std::vector<SpectralHump> humps() const;

    std::size_t length_;
    double rate_;
    PieceMaker maker_;
    std::size_t pieces_ = 0;
    std::vector<double> power_;  // squared amplitude of a line, sum over pieces; the mean from find_lines on
    double gain_ = 0.0;          // of density times rate over squared amplitude, likewise
    std::vector<double> floor_;  // mean noise power
    std::vector<SignificantPeak> found_;
    std::vector<SignificantHump> humps_;
    std::vector<LineMeter> meters_;
};

}  // namespace ripplenotch
