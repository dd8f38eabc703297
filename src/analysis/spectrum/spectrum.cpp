// SPDX-License-Identifier: MIT
#include "ripplenotch/analysis/spectrum.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "analysis/spectrum/line_meter.hpp"
#include "analysis/spectrum/pieces.hpp"
#include "ripplenotch/analysis/fourier.hpp"
#include "ripplenotch/analysis/line_test.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {

namespace {

/// Bins of the main lobe at zero of what the removal of a straight line leaves.
constexpr std::size_t trend_bins = 3;

/// Largest amplitude that a line of amplitude 1 shows `bins` away through a Hann window, side lobes included.
double leakage(double bins) {
    const double d = std::abs(bins);
    return d < 2.0 ? 1.0 : 1.0 / (std::numbers::pi * d * (d * d - 1.0));
}

constexpr double skirt_margin = 2.0;  ///< a side lobe may be this much higher than the window's own

/// Independent averages that half-overlapping Hann pieces are worth: neighbours share a sixth of their
/// amplitude and so 1/36 of their power in correlation, (1 + 2/36)^-1.
double independent_pieces(std::size_t pieces) {
    return std::max(1.0, static_cast<double>(pieces) / (pieces > 1 ? 1.0556 : 1.0));
}

// The mean spectrum of pieces that go by one after another: once for the power, and once more for the lines
// found in it.

class Welch {
  public:
    /// `length` samples a piece.
    Welch(std::size_t length, Hertz rate);

    /// First pass: consecutive samples, seconds and Nm. Returns how many are done with: the others are to
    /// come again, in front of those that follow them.
    std::size_t add(std::span<const double> time_s, std::span<const double> torque_nm);
    /// The result with another rate from the beginning on; empty where it cannot be determined.
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

    std::size_t length_;
    double rate_;
    PieceMaker maker_;
    std::size_t pieces_ = 0;
    std::vector<double> power_;  // squared amplitude of a line, sum over pieces; the mean from find_lines on
    double gain_ = 0.0;          // ratio of density times rate to squared amplitude, likewise
    std::vector<double> floor_;  // mean noise power
    std::vector<SignificantPeak> found_;
    std::vector<LineMeter> meters_;
};

constexpr double hann_error_factor =
    1.5307;  // standard error of a Hann-windowed frequency over the Cramer-Rao bound

/// Offset in bins of a Hann peak from the logs of three powers around it; within 0.02 bin, to be refined by
/// Newton's method.
double log_parabola(double left, double middle, double right) {
    if (!(left > 0.0) || !(right > 0.0)) return 0.0;
    const double a = portable::log(left), b = portable::log(middle), c = portable::log(right);
    const double bend = a - 2.0 * b + c;
    return bend < 0.0 ? std::clamp(0.5 * (a - c) / bend, -0.5, 0.5) : 0.0;
}

/// Drops peaks that are only the skirt of a stronger one, and those 100 dB below the strongest, where
/// rounding is the floor. `powers` by bin; strongest first on return.
std::vector<SignificantPeak> without_skirts(std::vector<SignificantPeak> found,
                                            std::span<const double> power) {
    std::stable_sort(found.begin(), found.end(), [&](const SignificantPeak& a, const SignificantPeak& b) {
        return power[a.bin] > power[b.bin];
    });
    std::vector<SignificantPeak> kept;
    for (const SignificantPeak& peak : found) {
        const double own = std::sqrt(power[peak.bin]);
        const bool skirt = std::any_of(kept.begin(), kept.end(), [&](const SignificantPeak& strong) {
            const double apart = static_cast<double>(peak.bin) - static_cast<double>(strong.bin);
            const double other = std::sqrt(power[strong.bin]);
            return own < skirt_margin * other * leakage(std::abs(apart) - 0.5) || own < 1e-5 * other;
        });
        if (!skirt) kept.push_back(peak);
    }
    return kept;
}

Welch::Welch(std::size_t length, Hertz rate)
    : length_(length), rate_(rate.value()), maker_(length, rate), power_(length / 2 + 1, 0.0) {}

std::size_t Welch::add(std::span<const double> time_s, std::span<const double> torque_nm) {
    return maker_.for_each(time_s, torque_nm, [this](const Piece& piece) {
        maker_.add_power(4.0 / (piece.window_sum * piece.window_sum), power_);
        gain_ += 0.5 * piece.window_sum * piece.window_sum / piece.window_square_sum;
        ++pieces_;
    });
}

PowerSpectrum Welch::tested() const {
    const double averages = independent_pieces(pieces_);
    // A single spectrum of red noise has maxima near its low end that few neighbouring cells do not explain.
    constexpr double unsearched_cells = 5.0;
    const std::size_t first = std::min(trend_bins, power_.size());
    return {power_, averages, hann_cell,
            first,  {},       first + static_cast<std::size_t>(std::ceil(unsearched_cells * hann_cell))};
}

std::optional<Welch> Welch::at(Hertz rate) const {
    if (!maker_.even_at(rate)) return std::nullopt;
    Welch other(length_, rate);
    other.pieces_ = pieces_;
    other.power_ = power_;
    other.gain_ = gain_;
    return other;
}

bool Welch::find_lines(double false_alarm) {
    maker_.begin_again();
    const double share = 1.0 / static_cast<double>(pieces_);
    for (double& power : power_) power *= share;
    gain_ *= share;
    floor_ = noise_floor(tested());
    found_ = without_skirts(significant_peaks(tested(), floor_, false_alarm), power_);
    for (const SignificantPeak& found : found_) {
        const std::size_t k = found.bin;
        const double between = log_parabola(power_[k - 1], power_[k], power_[k + 1]);
        LineMeter& meter = meters_.emplace_back((static_cast<double>(k) + between) * bin_hz(), bin_hz());
        if (pieces_ > 1) meter.expect_even_pieces(maker_.even_time_s());
    }
    return !found_.empty();
}

std::size_t Welch::measure(std::span<const double> time_s, std::span<const double> torque_nm) {
    return maker_.for_each(time_s, torque_nm, [this](const Piece& piece) {
        for (LineMeter& meter : meters_) meter.add(piece);
    });
}

SpectralPeak Welch::peak(std::size_t line) const {
    const LineMeter& meter = meters_[line];
    SpectralPeak peak;
    peak.hz = meter.hz();
    peak.amplitude_nm = meter.amplitude_nm();
    peak.floor_nm = std::sqrt(floor_[found_[line].bin]);  // the test's own floor leans to the safe side
    peak.snr = peak.amplitude_nm / peak.floor_nm;
    peak.false_alarm = found_[line].false_alarm;
    peak.phase_deg = std::remainder(meter.phase_rad() * degrees_per_radian, 360.0);
    // var f = 3 S / (pi^2 A^2 T^3) for one-sided noise density S; floor^2 = 2 S * noise bandwidth.
    const double duration = static_cast<double>(length_) / rate_;
    const double density = peak.floor_nm * peak.floor_nm / (2.0 * hann_cell * bin_hz());
    const double bound =
        std::sqrt(3.0 * density / (peak.amplitude_nm * peak.amplitude_nm * duration * duration * duration)) /
        std::numbers::pi;
    peak.hz_stderr =
        hann_error_factor * bound / std::sqrt(std::max(1.0, 0.5 * static_cast<double>(pieces_ + 1)));
    return peak;
}

Spectrum Welch::spectrum() const {
    Spectrum spectrum;
    spectrum.bin_width = Hertz(bin_hz());
    spectrum.resolution = Hertz(hann_cell * bin_hz());
    spectrum.piece_duration = Seconds(static_cast<double>(length_) / rate_);
    spectrum.pieces = pieces_;
    const std::size_t bins = power_.size(), first = tested().first;
    const bool even = length_ % 2 == 0;
    for (std::size_t k = 0; k < bins; ++k) {
        // At 0 Hz and at half the rate both halves of the two-sided spectrum fall on one bin.
        const double single = k == 0 || (even && k + 1 == bins) ? 0.5 : 1.0;
        spectrum.hz.push_back(static_cast<double>(k) * bin_hz());
        spectrum.amplitude_nm.push_back(std::sqrt(power_[k]) * single);
        spectrum.psd_nm2_hz.push_back(power_[k] * (gain_ / rate_) * single);
        spectrum.floor_nm.push_back(k < first ? 0.0 : std::sqrt(floor_[k]));
    }
    for (std::size_t line = 0; line < found_.size(); ++line) spectrum.peaks.push_back(peak(line));
    std::stable_sort(
        spectrum.peaks.begin(), spectrum.peaks.end(),
        [](const SpectralPeak& a, const SpectralPeak& b) { return a.amplitude_nm > b.amplitude_nm; });
    return spectrum;
}

}  // namespace

struct SpectrumStream::Work {
    Welch welch;
    std::vector<double> time_s = {}, torque_nm = {};  // incomplete pieces

    using Pass = std::size_t (Welch::*)(std::span<const double>, std::span<const double>);
    void feed(Pass pass, std::span<const double> more_s, std::span<const double> more_nm) {
        time_s.insert(time_s.end(), more_s.begin(), more_s.end());
        torque_nm.insert(torque_nm.end(), more_nm.begin(), more_nm.end());
        const auto done = static_cast<std::ptrdiff_t>((welch.*pass)(time_s, torque_nm));
        time_s.erase(time_s.begin(), time_s.begin() + done);
        torque_nm.erase(torque_nm.begin(), torque_nm.begin() + done);
    }
};

SpectrumStream::SpectrumStream(std::size_t length, Hertz rate)
    : work_(std::make_unique<Work>(Work{Welch(length, rate)})) {}

SpectrumStream::~SpectrumStream() = default;

SpectrumStream::SpectrumStream(SpectrumStream&&) noexcept = default;

SpectrumStream& SpectrumStream::operator=(SpectrumStream&&) noexcept = default;

void SpectrumStream::add(std::span<const double> time_s, std::span<const double> torque_nm) {
    work_->feed(&Welch::add, time_s, torque_nm);
}

bool SpectrumStream::settle(Hertz rate) {
    auto settled = work_->welch.at(rate);
    if (settled) work_->welch = std::move(*settled);
    return settled.has_value();
}

bool SpectrumStream::find_lines(double false_alarm) {
    work_->time_s.clear();
    work_->torque_nm.clear();
    return work_->welch.find_lines(false_alarm);
}

void SpectrumStream::measure(std::span<const double> time_s, std::span<const double> torque_nm) {
    work_->feed(&Welch::measure, time_s, torque_nm);
}

Spectrum SpectrumStream::spectrum() const { return work_->welch.spectrum(); }

std::size_t piece_length(std::size_t samples, Hertz rate, const SpectrumOptions& options) {
    std::size_t length = samples;
    if (options.segment) {
        const double asked = options.segment->value() * rate.value();
        length = std::min(length, static_cast<std::size_t>(std::llround(asked)));
    }
    return length;
}

void require_piece_length(std::size_t length, const SpectrumOptions& options) {
    if (length < fewest_spectrum_samples) {
        raise<DataError>("a spectrum needs at least {} samples, there are {}{}", fewest_spectrum_samples,
                         length, options.segment ? "; use a longer --segment" : "");
    }
}

Spectrum torque_spectrum(const TraceView& trace, const SpectrumOptions& options) {
    const std::size_t length = piece_length(trace.size(), trace.sample_rate, options);
    require_piece_length(length, options);
    Welch welch(length, trace.sample_rate);
    welch.add(trace.time_s, trace.torque_nm);
    if (welch.find_lines(options.false_alarm)) welch.measure(trace.time_s, trace.torque_nm);
    return welch.spectrum();
}

}  // namespace ripplenotch
