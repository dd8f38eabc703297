// SPDX-License-Identifier: MIT
#include "ripplenotch/analysis/spectrum.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <vector>

#include "core/functions/many_numbers.hpp"
#include "ripplenotch/analysis/line_test.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {

namespace {

/// Bins of the main lobe at zero of what the removal of a straight line leaves.
constexpr std::size_t trend_bins = 3;
/// A clock counts as even when no sample is off it by more than this share of a step: then the plain
/// transform is the same sum.
constexpr double even_share = 1e-3;
constexpr double most_steps = 3.0;  // longest interval of one sample, next to a gap

/// Amplitude that a line of amplitude 1 shows `bins` away through a Hann window.
double hann_lobe(double bins) {
    const double d = std::abs(bins);
    if (d < 1e-6) return 1.0;
    if (std::abs(d - 1.0) < 1e-6) return 0.5;
    return portable::sin(std::numbers::pi * d) / (std::numbers::pi * d * (1.0 - d * d));
}

/// Largest amplitude that it shows at least so far away, side lobes included.
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

/// Standard error of a frequency over the Cramer-Rao bound: from the powers of three bins it is 1.91 for a
/// line on a bin and 1.60 for one half a bin off (first-order errors of place_in_bins(), noise of neighbours
/// correlated by 2/3 and 1/6).
constexpr double bins_error_factor = 1.75;

/// Offset of a line from the middle one of three bins by the powers in them, without their noise. Each pair
/// of bins has the place of a sine exactly; the stronger pair counts more.
double place_in_bins(double left, double middle, double right) {
    const double a = std::sqrt(left), b = std::sqrt(middle), c = std::sqrt(right);
    if (!(left + right > 0.0)) return 0.0;
    const double place = (right * (2.0 * c - b) / (c + b) - left * (2.0 * a - b) / (a + b)) / (left + right);
    return std::clamp(place, -0.5, 0.5);
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

void remove_line(std::span<const double> t, std::span<double> x) {
    const auto n = static_cast<double>(x.size());
    const double mean = std::accumulate(x.begin(), x.end(), 0.0) / n;
    const double t_mean = std::accumulate(t.begin(), t.end(), 0.0) / n;
    double tt = 0.0, tx = 0.0;
    for (std::size_t k = 0; k < x.size(); ++k) {
        tt += (t[k] - t_mean) * (t[k] - t_mean);
        tx += (t[k] - t_mean) * (x[k] - mean);
    }
    const double slope = tt > 0.0 ? tx / tt : 0.0;
    for (std::size_t k = 0; k < x.size(); ++k) x[k] -= mean + slope * (t[k] - t_mean);
}

}  // namespace

SpectrumStream::SpectrumStream(std::size_t length, Hertz rate)
    : length_(length), rate_(rate.value()), transform_(length), power_(length / 2 + 1, 0.0) {}

void SpectrumStream::add(std::span<const double> time_s, std::span<const double> torque_nm) {
    time_s_.insert(time_s_.end(), time_s.begin(), time_s.end());
    torque_nm_.insert(torque_nm_.end(), torque_nm.begin(), torque_nm.end());
    std::size_t done = 0;
    for (; done + length_ <= time_s_.size(); done += std::max<std::size_t>(1, length_ / 2))
        add_piece(std::span(time_s_).subspan(done, length_), std::span(torque_nm_).subspan(done, length_));
    time_s_.erase(time_s_.begin(), time_s_.begin() + static_cast<std::ptrdiff_t>(done));
    torque_nm_.erase(torque_nm_.begin(), torque_nm_.begin() + static_cast<std::ptrdiff_t>(done));
}

void SpectrumStream::add_piece(std::span<const double> time_s, std::span<const double> torque_nm) {
    const std::size_t n = length_;
    const double middle_s = 0.5 * (time_s.front() + time_s.back()), step_s = 1.0 / rate_;
    place_s_.resize(n);
    bool even = true;
    for (std::size_t k = 0; k < n; ++k) {
        place_s_[k] = time_s[k] - middle_s;
        const double off = place_s_[k] - place_s_.front() - static_cast<double>(k) * step_s;
        even = even && std::abs(off) <= even_share * step_s;
    }
    const std::span<double> value = transform_.in();
    std::copy(torque_nm.begin(), torque_nm.end(), value.begin());
    remove_line(place_s_, value);
    window_.resize(n);
    for (std::size_t k = 0; k < n; ++k)
        window_[k] = full_turn * place_s_[k] / (static_cast<double>(n) * step_s);
    portable::cos(window_, window_);
    double sum = 0.0, square = 0.0;
    for (std::size_t k = 0; k < n; ++k) {
        // Each sample stands for the time around it. Were all alike, a clock that stumbles in a pattern would
        // make lines of that pattern out of the slow motion, a hundred times stronger than any ripple.
        const double around = place_s_[std::min(k + 1, n - 1)] - place_s_[k > 0 ? k - 1 : k];
        const double share = even ? 1.0 : std::clamp(0.5 * around / step_s, 0.0, most_steps);
        const double weight = share * (0.5 + 0.5 * window_[k]);
        value[k] *= weight;
        sum += weight;
        square += weight * weight;
    }
    std::vector<std::complex<double>> uneven;
    if (!even) uneven = nonuniform_fourier(place_s_, value, bin_hz(), power_.size());
    const auto sums = even ? transform_.run() : std::span<const std::complex<double>>(uneven);
    const double scale = 4.0 / (sum * sum);
    for (std::size_t k = 0; k < sums.size(); ++k)
        power_[k] += scale * (sums[k].real() * sums[k].real() + sums[k].imag() * sums[k].imag());
    gain_ += 0.5 * sum * sum / square;
    if (pieces_++ > 0) return;
    first_middle_s_ = middle_s;
    first_sums_.assign(sums.begin(), sums.end());
    // The plain transform counts from the first sample.
    for (std::size_t k = 0; even && k < first_sums_.size(); ++k)
        first_sums_[k] *= portable::phasor(-full_turn * bin_hz() * static_cast<double>(k) * place_s_.front());
}

SpectralPeak SpectrumStream::peak(const SignificantPeak& found, std::span<const double> power,
                                  double floor) const {
    const std::size_t k = found.bin;
    const double left = std::max(power[k - 1] - floor, 0.0), middle = std::max(power[k] - floor, 0.0),
                 right = std::max(power[k + 1] - floor, 0.0);
    const double off = place_in_bins(left, middle, right);
    double lobes = 0.0;
    for (const double bin : {-1.0, 0.0, 1.0}) lobes += hann_lobe(off - bin) * hann_lobe(off - bin);
    SpectralPeak peak;
    peak.hz = (static_cast<double>(k) + off) * bin_hz();
    peak.amplitude_nm = std::sqrt((left + middle + right) / lobes);
    peak.floor_nm = std::sqrt(floor);  // the test's own floor leans to the safe side
    peak.snr = peak.amplitude_nm / peak.floor_nm;
    peak.false_alarm = found.false_alarm;
    peak.phase_deg = std::remainder(
        (portable::arg(first_sums_[k]) - full_turn * peak.hz * first_middle_s_) * degrees_per_radian, 360.0);
    // var f = 3 S / (pi^2 A^2 T^3) for one-sided noise density S; floor^2 = 2 S * noise bandwidth.
    const double duration = static_cast<double>(length_) / rate_;
    const double density = floor / (2.0 * hann_cell * bin_hz());
    const double bound =
        std::sqrt(3.0 * density / (peak.amplitude_nm * peak.amplitude_nm * duration * duration * duration)) /
        std::numbers::pi;
    peak.hz_stderr = bins_error_factor * bound / std::sqrt(independent_pieces(pieces_));
    return peak;
}

Spectrum SpectrumStream::spectrum(double false_alarm) const {
    Spectrum spectrum;
    spectrum.bin_width = Hertz(bin_hz());
    spectrum.resolution = Hertz(hann_cell * bin_hz());
    spectrum.piece_duration = Seconds(static_cast<double>(length_) / rate_);
    spectrum.pieces = pieces_;
    const std::size_t bins = power_.size(), first = std::min(trend_bins, bins);
    const bool even = length_ % 2 == 0;
    std::vector<double> power(power_);
    for (double& one : power) one /= static_cast<double>(pieces_);
    // A single spectrum of red noise has maxima near its low end that few neighbouring cells do not explain.
    constexpr double unsearched_cells = 5.0;
    const PowerSpectrum tested{power, independent_pieces(pieces_), hann_cell, first,
                               first + static_cast<std::size_t>(std::ceil(unsearched_cells * hann_cell))};
    const std::vector<double> floor = noise_floor(tested);
    const double gain = gain_ / static_cast<double>(pieces_);
    for (std::size_t k = 0; k < bins; ++k) {
        // At 0 Hz and at half the rate both halves of the two-sided spectrum fall on one bin.
        const double single = k == 0 || (even && k + 1 == bins) ? 0.5 : 1.0;
        spectrum.hz.push_back(static_cast<double>(k) * bin_hz());
        spectrum.amplitude_nm.push_back(std::sqrt(power[k]) * single);
        spectrum.psd_nm2_hz.push_back(power[k] * (gain / rate_) * single);
        spectrum.floor_nm.push_back(k < first ? 0.0 : std::sqrt(floor[k]));
    }
    for (const SignificantPeak& found : without_skirts(significant_peaks(tested, floor, false_alarm), power))
        spectrum.peaks.push_back(peak(found, power, floor[found.bin]));
    std::stable_sort(
        spectrum.peaks.begin(), spectrum.peaks.end(),
        [](const SpectralPeak& a, const SpectralPeak& b) { return a.amplitude_nm > b.amplitude_nm; });
    return spectrum;
}

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
    SpectrumStream stream(length, trace.sample_rate);
    stream.add(trace.time_s, trace.torque_nm);
    return stream.spectrum(options.false_alarm);
}

}  // namespace ripplenotch
