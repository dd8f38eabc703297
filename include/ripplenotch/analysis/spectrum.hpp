// SPDX-License-Identifier: MIT
#pragma once
// Amplitude of torque against frequency: the paper's windowed DFT, in newton-metres, with its lines and their
// false-alarm probability.

#include <complex>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "ripplenotch/analysis/fourier.hpp"
#include "ripplenotch/analysis/line_test.hpp"
#include "ripplenotch/core/quantity.hpp"
#include "ripplenotch/core/trace.hpp"

namespace ripplenotch {

/// A line of a spectrum, between bins. Amplitudes are zero to peak.
struct SpectralPeak {
    double hz = 0.0;
    double hz_stderr = 0.0;  ///< Cramer-Rao bound at this floor, times 1.75 for three bins of a Hann window
    double amplitude_nm = 0.0;  ///< rms over pieces, noise power subtracted
    double phase_deg = 0.0;     ///< phase in cos(2 pi f t + phase) in the first piece, t as in the log
    double floor_nm = 0.0;      ///< amplitude that noise alone shows here, rms
    double snr = 0.0;           ///< amplitude_nm / floor_nm
    double false_alarm = 1.0;   ///< chance that noise shows such a line anywhere in this spectrum
};

struct SpectrumOptions {
    std::optional<Seconds> segment;  ///< Welch: length of the pieces, half overlapping; left out: one piece
    double false_alarm = 0.01;       ///< chance that noise gives any of `peaks`
};

/// Bins run from 0 Hz to half the sample rate, all vectors have the same length.
struct Spectrum {
    std::vector<double> hz;
    std::vector<double> amplitude_nm;  ///< a sine on a bin shows its amplitude; rms over pieces
    std::vector<double> psd_nm2_hz;    ///< one-sided
    std::vector<double> floor_nm;      ///< noise floor as an amplitude, rms; 0 where it cannot be known
    std::vector<SpectralPeak> peaks;   ///< strongest first
    Hertz bin_width;
    Hertz resolution;  ///< bin_width times 1.5, the noise bandwidth of a Hann window
    std::size_t pieces = 0;
    Seconds piece_duration;
};

inline constexpr std::size_t fewest_spectrum_samples = 64;  ///< chosen, not derived
/// Samples that a piece has, of so many.
[[nodiscard]] std::size_t piece_length(std::size_t samples, Hertz rate, const SpectrumOptions& options);
/// Throws DataError for fewer.
void require_piece_length(std::size_t length, const SpectrumOptions& options);

/// Hann window, straight line removed per piece. Samples are taken at their own times, so that a jittered
/// clock moves no line and makes none (regular clocks use a plain FFT). Throws DataError for fewer than 64
/// samples. Cost O(n log n). Method: Heinzel, Ruediger, Schilling 2002 (windows and scaling); peaks by the
/// powers of the three bins around a maximum, in which a sine has its place and size exactly.
[[nodiscard]] Spectrum torque_spectrum(const TraceView& trace, const SpectrumOptions& options);

/// torque_spectrum of samples that go by and are not held.
class SpectrumStream {
  public:
    /// `length` samples a piece, from piece_length.
    SpectrumStream(std::size_t length, Hertz rate);

    /// Consecutive samples, seconds and Nm, any number at a time. Holds one piece besides.
    void add(std::span<const double> time_s, std::span<const double> torque_nm);
    /// That of torque_spectrum for the same samples, bit for bit. At least one piece has been added.
    [[nodiscard]] Spectrum spectrum(double false_alarm) const;

  private:
    void add_piece(std::span<const double> time_s, std::span<const double> torque_nm);
    [[nodiscard]] double bin_hz() const { return rate_ / static_cast<double>(length_); }
    [[nodiscard]] SpectralPeak peak(const SignificantPeak& found, std::span<const double> power,
                                    double floor) const;

    std::size_t length_;
    double rate_;
    RealTransform transform_;
    std::vector<double> time_s_ = {}, torque_nm_ = {};  ///< of the piece under way
    std::vector<double> place_s_ = {}, window_ = {};    ///< of a piece, for the next one to reuse
    std::size_t pieces_ = 0;
    std::vector<double> power_;  ///< squared amplitude of a line, sum over pieces
    double gain_ = 0.0;          ///< ratio of density times rate to squared amplitude, likewise
    std::vector<std::complex<double>> first_sums_ = {};  ///< of the first piece, from its middle
    double first_middle_s_ = 0.0;
};

}  // namespace ripplenotch
