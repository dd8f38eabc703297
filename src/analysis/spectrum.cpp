// SPDX-License-Identifier: MIT
#include "ripplenotch/analysis/spectrum.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <numeric>

#include "ripplenotch/analysis/fourier.hpp"
#include "ripplenotch/analysis/line_test.hpp"
#include "ripplenotch/core/error.hpp"

namespace ripplenotch {
namespace {

constexpr std::size_t fewest_samples = 64;
constexpr double hann_noise_bandwidth = 1.5;  // bins
constexpr double hann_error_factor =
    1.5307;                           // standard error of a Hann-windowed frequency over the Cramer-Rao bound
constexpr double skirt_margin = 2.0;  // a side lobe may be this much higher than the window's own
constexpr std::size_t trend_bins = 3;  // main lobe of what the straight line leaves at zero

/// A piece of the log, detrended and windowed, with times from its own middle.
struct Piece {
    std::vector<double> time_s, value;
    double middle_s = 0.0;
    double window_sum = 0.0, window_square_sum = 0.0;
};

void remove_line(std::span<const double> t, std::vector<double>& x) {
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

Piece make_piece(const TraceView& part) {
    const std::size_t n = part.size();
    const double step = 1.0 / part.sample_rate.value();
    const double length = static_cast<double>(n) * step;
    Piece piece;
    piece.middle_s = 0.5 * (part.time_s.front() + part.time_s.back());
    piece.time_s.resize(n);
    piece.value.assign(part.torque_nm.begin(), part.torque_nm.end());
    for (std::size_t k = 0; k < n; ++k) piece.time_s[k] = part.time_s[k] - piece.middle_s;
    remove_line(piece.time_s, piece.value);
    for (std::size_t k = 0; k < n; ++k) {
        const double window = 0.5 + 0.5 * std::cos(2.0 * std::numbers::pi * piece.time_s[k] / length);
        piece.value[k] *= window;
        piece.window_sum += window;
        piece.window_square_sum += window * window;
    }
    return piece;
}

/// True when every sample lies within a thousandth of a step of a regular clock: then the plain FFT is the
/// same sum.
bool regular(std::span<const double> time_s, double step) {
    for (std::size_t k = 0; k < time_s.size(); ++k) {
        if (std::abs(time_s[k] - time_s.front() - static_cast<double>(k) * step) > 1e-3 * step) return false;
    }
    return true;
}

std::vector<std::complex<double>> transform(const Piece& piece, double step, double bin_width) {
    const std::size_t bins = piece.value.size() / 2 + 1;
    if (regular(piece.time_s, step)) return real_fourier(piece.value);
    return nonuniform_fourier(piece.time_s, piece.value, bin_width, bins);
}

/// Offset in bins of a Hann peak from the logs of three powers around it; within 0.02 bin, the rest is for
/// Newton.
double log_parabola(double left, double middle, double right) {
    if (!(left > 0.0) || !(right > 0.0)) return 0.0;
    const double a = std::log(left), b = std::log(middle), c = std::log(right);
    const double bend = a - 2.0 * b + c;
    return bend < 0.0 ? std::clamp(0.5 * (a - c) / bend, -0.5, 0.5) : 0.0;
}

SpectralPeak measure_peak(const std::vector<Piece>& pieces, const std::vector<double>& power,
                          const Spectrum& spectrum, const SignificantPeak& found) {
    const double bin_width = spectrum.bin_width.value();
    const std::size_t k = found.bin;
    const double start =
        (static_cast<double>(k) + log_parabola(power[k - 1], power[k], power[k + 1])) * bin_width;
    // Pieces share the frequency, each has its own phase: the mean of their maxima, weighted by their power.
    double weights = 0.0, mean = 0.0, square = 0.0;
    std::complex<double> strongest;
    double strongest_middle = 0.0;
    for (const Piece& piece : pieces) {
        const double at = refine_peak(piece.time_s, piece.value, start, bin_width);
        const std::complex<double> sum =
            2.0 * fourier_point(piece.time_s, piece.value, at).value / piece.window_sum;
        const double weight = std::norm(sum);
        weights += weight;
        mean += weight * at;
        square += weight;
        if (std::norm(sum) > std::norm(strongest)) {
            strongest = sum;
            strongest_middle = piece.middle_s;
        }
    }
    SpectralPeak peak;
    peak.hz = weights > 0.0 ? mean / weights : start;
    peak.amplitude_nm = std::sqrt(square / static_cast<double>(pieces.size()));
    peak.floor_nm = spectrum.floor_nm[k];  // the test's own floor leans to the safe side
    peak.snr = peak.amplitude_nm / peak.floor_nm;
    peak.false_alarm = found.false_alarm;
    const double phase = std::arg(strongest) - 2.0 * std::numbers::pi * peak.hz * strongest_middle;
    peak.phase_deg = std::remainder(phase * degrees_per_radian, 360.0);
    // var f = 3 S / (pi^2 A^2 T^3) for one-sided noise density S; floor^2 = 2 S * noise bandwidth.
    const double duration = spectrum.piece_duration.value();
    const double density = peak.floor_nm * peak.floor_nm / (2.0 * hann_noise_bandwidth * bin_width);
    const double bound =
        std::sqrt(3.0 * density / (peak.amplitude_nm * peak.amplitude_nm * duration * duration * duration)) /
        std::numbers::pi;
    peak.hz_stderr =
        hann_error_factor * bound / std::sqrt(std::max(1.0, 0.5 * static_cast<double>(pieces.size() + 1)));
    return peak;
}

/// Largest amplitude that a line of amplitude 1 shows `bins` away through a Hann window, side lobes included.
double leakage(double bins) {
    const double d = std::abs(bins);
    return d < 2.0 ? 1.0 : 1.0 / (std::numbers::pi * d * (d * d - 1.0));
}

/// Drops what is only the skirt of a stronger peak, and what lies 100 dB below the strongest, where rounding
/// is the floor. `powers` by bin; strongest first on return.
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

std::vector<Piece> cut(const TraceView& trace, std::size_t length) {
    std::vector<Piece> pieces;
    const std::size_t hop = std::max<std::size_t>(1, length / 2);
    for (std::size_t first = 0; first + length <= trace.size(); first += hop) {
        pieces.push_back(make_piece(trace.part(first, length)));
    }
    return pieces;
}

}  // namespace

Spectrum torque_spectrum(const TraceView& trace, const SpectrumOptions& options) {
    const double rate = trace.sample_rate.value();
    std::size_t length = trace.size();
    if (options.segment) {
        length = std::min(length, static_cast<std::size_t>(std::llround(options.segment->value() * rate)));
    }
    if (length < fewest_samples) {
        raise<DataError>("a spectrum needs at least {} samples, there are {}{}", fewest_samples, length,
                         options.segment ? "; use a longer --segment" : "");
    }
    const double step = 1.0 / rate;
    Spectrum spectrum;
    spectrum.bin_width = Hertz(rate / static_cast<double>(length));
    spectrum.resolution = Hertz(hann_noise_bandwidth * spectrum.bin_width.value());
    spectrum.piece_duration = Seconds(static_cast<double>(length) * step);
    const std::vector<Piece> pieces = cut(trace, length);
    spectrum.pieces = pieces.size();

    const std::size_t bins = length / 2 + 1;
    std::vector<double> power(bins, 0.0);  // squared amplitude of a line, mean over pieces
    double gain = 0.0;                     // of density over squared amplitude
    for (const Piece& piece : pieces) {
        const auto sums = transform(piece, step, spectrum.bin_width.value());
        const double scale = 4.0 / (piece.window_sum * piece.window_sum * static_cast<double>(pieces.size()));
        for (std::size_t k = 0; k < bins; ++k) power[k] += scale * std::norm(sums[k]);
        gain += 0.5 * piece.window_sum * piece.window_sum / (piece.window_square_sum * rate) /
                static_cast<double>(pieces.size());
    }
    const bool even = length % 2 == 0;
    const std::size_t first = std::min(trend_bins, bins);
    // Half-overlapping Hann pieces: neighbours share a sixth of their power in correlation, (1 + 2/36)^-1.
    const double averages =
        std::max(1.0, static_cast<double>(pieces.size()) / (pieces.size() > 1 ? 1.0556 : 1.0));
    const PowerSpectrum tested{power, averages, hann_noise_bandwidth, first};
    const std::vector<double> floor = noise_floor(tested);
    for (std::size_t k = 0; k < bins; ++k) {
        // At 0 Hz and at half the rate both halves of the two-sided spectrum fall on one bin.
        const double single = k == 0 || (even && k + 1 == bins) ? 0.5 : 1.0;
        spectrum.hz.push_back(static_cast<double>(k) * spectrum.bin_width.value());
        spectrum.amplitude_nm.push_back(std::sqrt(power[k]) * single);
        spectrum.psd_nm2_hz.push_back(power[k] * gain * single);
        spectrum.floor_nm.push_back(k < first ? 0.0 : std::sqrt(floor[k]));
    }
    spectrum.trend_removed_to_hz = static_cast<double>(first) * spectrum.bin_width.value();
    for (const SignificantPeak& found :
         without_skirts(significant_peaks(tested, options.false_alarm), power)) {
        spectrum.peaks.push_back(measure_peak(pieces, power, spectrum, found));
    }
    std::stable_sort(
        spectrum.peaks.begin(), spectrum.peaks.end(),
        [](const SpectralPeak& a, const SpectralPeak& b) { return a.amplitude_nm > b.amplitude_nm; });
    return spectrum;
}

}  // namespace ripplenotch
