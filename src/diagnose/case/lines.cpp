// SPDX-License-Identifier: MIT
#include "diagnose/case/lines.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstddef>
#include <numbers>
#include <utility>
#include <vector>

#include "diagnose/limits.hpp"
#include "ripplenotch/analysis/fourier.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {

namespace {

/// Cell k is at k * spacing, in cycles per unit of the places.
struct LineSpectrum {
    double spacing = 0.0;
    std::vector<double> power;  ///< squared amplitude, Nm^2
};

}  // namespace

double range_of(const LineSamples& samples) {
    const auto [low, high] = std::minmax_element(samples.where.begin(), samples.where.end());
    return std::max(*high - *low, 1e-9);
}

namespace {

LineSpectrum spectrum_of(const LineSamples& samples, double spacing, std::size_t count) {
    LineSpectrum spectrum{spacing, {}};
    const auto sums = nonuniform_fourier(samples.where, samples.value, spacing, count);
    const double scale = 2.0 / static_cast<double>(samples.value.size());
    for (const auto& sum : sums) spectrum.power.push_back(std::norm(scale * sum));
    return spectrum;
}

// As finely spaced as the range of the samples resolves, up to `highest` or limits::lines::most_cells.
LineSpectrum spectrum_of(const LineSamples& samples, double highest) {
    const double spacing = 1.0 / (limits::lines::oversampling * range_of(samples));
    return spectrum_of(
        samples, spacing,
        std::min(static_cast<std::size_t>(std::max(highest / spacing, 1.0)) + 1, limits::lines::most_cells));
}

// A residual against time, in the form used to search for tones. For a log with long gaps it is the mean of
// the spectra of its pieces: a spectrum of the whole would be a comb of lines, or end below the resolution of
// the sampling.

class Tones {
  public:
    /// LineSamples against time in s, in its order.
    Tones(LineSamples samples, double rate_hz);

    /// In Hz and Nm^2.
    [[nodiscard]] const LineSpectrum& spectrum() const { return spectrum_; }
    /// The frequency about a cell of the spectrum; of pieces the one at which they agree best.
    [[nodiscard]] double refined_hz(std::size_t cell) const;

  private:
    [[nodiscard]] double agreed_hz(double mean_hz, double error_hz) const;

    LineSamples all_;
    std::vector<LineSamples> pieces_;  ///< none where the whole is used
    LineSpectrum spectrum_;
};

// Runs of samples without a gap.
std::vector<LineSamples> pieces_of(const LineSamples& samples, double usual_step) {
    std::vector<LineSamples> pieces(1);
    for (std::size_t k = 0; k < samples.where.size(); ++k) {
        if (k > 0 && samples.where[k] - samples.where[k - 1] > limits::lines::gap_steps * usual_step) {
            if (pieces.back().where.size() < limits::lines::fewest_samples) pieces.pop_back();
            pieces.emplace_back();
        }
        pieces.back().where.push_back(samples.where[k]);
        pieces.back().value.push_back(samples.value[k]);
    }
    if (pieces.back().where.size() < limits::lines::fewest_samples) pieces.pop_back();
    return pieces;
}

Tones::Tones(LineSamples samples, double rate_hz) : all_(std::move(samples)) {
    const double highest_hz = 0.5 * rate_hz;
    const double recorded_s = static_cast<double>(all_.where.size()) / rate_hz, range_s = range_of(all_);
    if (recorded_s < limits::lines::recorded_part * range_s ||
        limits::lines::oversampling * range_s * highest_hz > static_cast<double>(limits::lines::most_cells))
        pieces_ = pieces_of(all_, 1.0 / rate_hz);
    if (pieces_.empty()) {
        spectrum_ = spectrum_of(all_, highest_hz);
        return;
    }
    double longest_s = 0.0, counted = 0.0;
    for (const LineSamples& piece : pieces_) {
        longest_s = std::max(longest_s, range_of(piece));
        counted += static_cast<double>(piece.where.size());
    }
    spectrum_.spacing = 1.0 / (limits::lines::oversampling * longest_s);
    spectrum_.power.assign(
        std::min(static_cast<std::size_t>(highest_hz / spectrum_.spacing) + 1, limits::lines::most_cells),
        0.0);
    for (const LineSamples& piece : pieces_) {
        const LineSpectrum own = spectrum_of(piece, spectrum_.spacing, spectrum_.power.size());
        const double part = static_cast<double>(piece.where.size()) / counted;
        for (std::size_t k = 0; k < own.power.size(); ++k) spectrum_.power[k] += part * own.power[k];
    }
}

double Tones::refined_hz(std::size_t cell) const {
    const double about_hz = static_cast<double>(cell) * spectrum_.spacing;
    if (pieces_.empty())
        return refine_peak(all_.where, all_.value, {.frequency = about_hz, .reach = spectrum_.spacing});
    std::vector<double> own_hz, weight;
    double weights = 0.0, sum = 0.0, squares = 0.0;
    for (const LineSamples& piece : pieces_) {
        own_hz.push_back(
            refine_peak(piece.where, piece.value, {.frequency = about_hz, .reach = spectrum_.spacing}));
        weight.push_back(std::norm(fourier_point(piece.where, piece.value, own_hz.back()).value) + 1e-300);
        weights += weight.back();
        sum += weight.back() * own_hz.back();
    }
    const double mean_hz = sum / weights;
    for (std::size_t p = 0; p < pieces_.size(); ++p)
        squares += weight[p] * (own_hz[p] - mean_hz) * (own_hz[p] - mean_hz);
    const double error_hz = std::sqrt(squares / weights / static_cast<double>(pieces_.size()));
    return refine_peak(all_.where, all_.value,
                       {.frequency = agreed_hz(mean_hz, error_hz), .reach = 0.5 / range_of(all_)});
}

// Near a frequency, where the sums of the pieces are in step.
double Tones::agreed_hz(double mean_hz, double error_hz) const {
    // Sums about the middle of each piece, with their slopes: near the mean frequency they are a parabola.
    std::vector<FourierPoint> sums;
    std::vector<double> middle_s;
    for (const LineSamples& piece : pieces_) {
        const double middle = 0.5 * (piece.where.front() + piece.where.back());
        std::vector<double> about = piece.where;
        for (double& time : about) time -= middle;
        sums.push_back(fourier_point(about, piece.value, mean_hz));
        middle_s.push_back(middle - pieces_.front().where.front());
    }
    const double step_hz = 1.0 / (limits::lines::oversampling * range_of(all_));
    const auto reach = static_cast<int>(std::min(limits::lines::agreement_errors * error_hz / step_hz,
                                                 static_cast<double>(limits::lines::agreement_cells)));
    double best_hz = mean_hz, most_power = -1.0;
    for (int i = -reach; i <= reach; ++i) {
        const double off_hz = i * step_hz;
        std::complex<double> sum;
        for (std::size_t p = 0; p < sums.size(); ++p) {
            const auto own = sums[p].value + off_hz * (sums[p].first + 0.5 * off_hz * sums[p].second);
            sum += own * portable::polar(1.0, -2.0 * std::numbers::pi * (mean_hz + off_hz) * middle_s[p]);
        }
        if (std::norm(sum) <= most_power) continue;
        most_power = std::norm(sum);
        best_hz = mean_hz + off_hz;
    }
    return best_hz;
}

constexpr std::array edges_hz = {1.0, 10.0};

// rms in each band.
std::array<double, 3> rms_by_band(std::span<const double> values, Hertz sample_rate, bool with_mean) {
    std::vector<double> finite(values.begin(), values.end());
    for (double& value : finite) value = std::isfinite(value) ? value : 0.0;
    const auto sums = real_fourier(finite);
    const auto samples = static_cast<double>(finite.size());
    std::array<double, 3> bands{};
    for (std::size_t cell = with_mean ? 0 : 1; cell < sums.size(); ++cell) {
        const double hz = sample_rate.value() / samples * static_cast<double>(cell);
        const bool single = cell == 0 || 2 * cell == finite.size();
        bands[hz < edges_hz[0] ? 0 : (hz < edges_hz[1] ? 1 : 2)] +=
            (single ? 1.0 : 2.0) * std::norm(sums[cell]);
    }
    for (double& band : bands) band = std::sqrt(band) / samples;
    return bands;
}

}  // namespace

std::vector<BandGap> band_gaps(std::span<const double> torque_nm, std::span<const double> beside_given_nm,
                               std::span<const double> after_nm, Hertz sample_rate) {
    const auto torque = rms_by_band(torque_nm, sample_rate, false),
               beside = rms_by_band(beside_given_nm, sample_rate, true),
               after = rms_by_band(after_nm, sample_rate, true);
    std::vector<BandGap> bands = {
        {0.0, edges_hz[0], 0, 0, 0}, {edges_hz[0], edges_hz[1], 0, 0, 0}, {edges_hz[1], 0.0, 0, 0, 0}};
    for (std::size_t b = 0; b < bands.size(); ++b) {
        bands[b].torque_nm = torque[b];
        bands[b].beside_given_nm = beside[b];
        bands[b].after_nm = after[b];
    }
    return bands;
}

namespace {

LineSamples counted(const Case& c, const std::vector<double>& where, const std::vector<double>& values) {
    LineSamples samples;
    for (std::size_t k = 0; k < c.size(); ++k) {
        if (c.use[k] == 0) continue;
        samples.where.push_back(where[k]);
        samples.value.push_back(values[k]);
    }
    return samples;
}

// Median power of blocks, as a background that a line cannot raise.
std::vector<double> background(const std::vector<double>& power, std::size_t block) {
    std::vector<double> medians;
    for (std::size_t first = 0; first < power.size(); first += block) {
        const std::size_t begin = std::min(first, power.size() > block ? power.size() - block : 0);
        std::vector<double> part(
            power.begin() + static_cast<std::ptrdiff_t>(begin),
            power.begin() + static_cast<std::ptrdiff_t>(std::min(begin + block, power.size())));
        std::nth_element(part.begin(), part.begin() + static_cast<std::ptrdiff_t>(part.size() / 2),
                         part.end());
        medians.push_back(part[part.size() / 2]);
    }
    std::vector<double> all(power.size());
    for (std::size_t k = 0; k < power.size(); ++k) all[k] = medians[k / block] + 1e-300;
    return all;
}

// Against the angle each stretch of it counts the same, however long the joint stayed there: standstill and
// slow passes would spread a line over its whole neighbourhood.
LineSamples evenly_by_angle(const Case& c, const std::vector<double>& values) {
    LineSamples samples;
    double sum = 0.0;
    for (std::size_t k = 0; k < c.size(); ++k) {
        const double speed = std::abs(c.motion.velocity_deg_s[k]);
        if (c.use[k] == 0 || speed < c.moving_deg_s) continue;
        samples.where.push_back(c.motion.position_deg[k]);
        samples.value.push_back(values[k] * speed);
        sum += speed;
    }
    for (double& value : samples.value) value *= static_cast<double>(samples.value.size()) / sum;
    return samples;
}

double highest_cycles_per_deg(const Case& c) {
    // Order 8.6 of a hundredfold gear, or the limit of the sampling at moderate speed: beyond, noise alone.
    double fastest = 0.0;
    for (const double v : c.motion.velocity_deg_s) fastest = std::max(fastest, std::abs(v));
    return 0.5 * c.motion.sample_rate.value() / std::max(limits::lines::moderate_speed * fastest, 1.0);
}

struct Peak {
    std::size_t cell;
    double prominence;
};

std::vector<Peak> peaks_of(const LineSpectrum& spectrum, std::size_t first, double least) {
    const auto floor = background(spectrum.power, limits::lines::background_cells);
    std::vector<Peak> peaks;
    for (std::size_t k = std::max<std::size_t>(first, 1); k + 1 < spectrum.power.size(); ++k) {
        if (spectrum.power[k] < spectrum.power[k - 1] || spectrum.power[k] < spectrum.power[k + 1]) continue;
        // ln 2 of the mean is the median of exponentially distributed power.
        const double prominence = spectrum.power[k] / floor[k] * portable::log(2.0);
        if (prominence >= least) peaks.push_back({k, prominence});
    }
    std::sort(peaks.begin(), peaks.end(),
              [](const Peak& a, const Peak& b) { return a.prominence > b.prominence; });
    return peaks;
}

void gather_by_angle(const Case& c, const std::vector<double>& residual_nm, double least,
                     std::vector<ResidualLine>& lines) {
    const LineSamples samples = evenly_by_angle(c, residual_nm);
    if (samples.where.size() < limits::lines::fewest_samples ||
        !(range_of(samples) > limits::lines::least_range))
        return;
    const LineSpectrum spectrum = spectrum_of(samples, highest_cycles_per_deg(c));
    // Slow orders are matters of gravity and friction.
    const auto first =
        static_cast<std::size_t>(limits::lines::fewest_cycles_per_turn / 360.0 / spectrum.spacing) + 1;
    for (const Peak& peak : peaks_of(spectrum, first, least)) {
        const double cell = static_cast<double>(peak.cell) * spectrum.spacing;
        lines.push_back(
            {true, refine_peak(samples.where, samples.value, {.frequency = cell, .reach = spectrum.spacing}),
             std::sqrt(spectrum.power[peak.cell]), peak.prominence});
        if (lines.size() > limits::lines::most_peaks) break;
    }
}

void gather_by_time(const Case& c, const std::vector<double>& residual_nm, double least,
                    std::vector<ResidualLine>& lines) {
    LineSamples samples = counted(c, c.motion.time_s, residual_nm);
    if (samples.where.size() < limits::lines::fewest_samples ||
        !(range_of(samples) > limits::lines::least_range))
        return;
    const Tones tones(std::move(samples), c.motion.sample_rate.value());
    // Slow tones are matters of drift.
    const auto first =
        static_cast<std::size_t>(limits::lines::slowest_tone_hz / tones.spectrum().spacing) + 1;
    for (const Peak& peak : peaks_of(tones.spectrum(), first, least)) {
        lines.push_back({false, tones.refined_hz(peak.cell), std::sqrt(tones.spectrum().power[peak.cell]),
                         peak.prominence});
        if (lines.size() > limits::lines::most_peaks) break;
    }
}

}  // namespace

std::vector<ResidualLine> standing_out(const Case& looked_at, const std::vector<double>& residual_nm,
                                       double least, std::size_t most) {
    std::vector<ResidualLine> lines, by_angle;
    gather_by_time(looked_at, residual_nm, least, lines);
    gather_by_angle(looked_at, residual_nm, least, by_angle);
    lines.insert(lines.end(), by_angle.begin(), by_angle.end());
    std::sort(lines.begin(), lines.end(),
              [](const ResidualLine& a, const ResidualLine& b) { return a.prominence > b.prominence; });
    if (lines.size() > most) lines.resize(most);
    return lines;
}

std::vector<double> strongest_tones_hz(const Case& looked_at, const std::vector<double>& residual_nm) {
    LineSamples samples = counted(looked_at, looked_at.motion.time_s, residual_nm);
    if (samples.where.size() < limits::lines::fewest_samples) return {};
    const Tones seen(std::move(samples), looked_at.motion.sample_rate.value());
    const auto first = static_cast<std::size_t>(limits::lines::slowest_tone_hz / seen.spectrum().spacing) + 1;
    std::vector<double> tones;
    for (const Peak& peak : peaks_of(seen.spectrum(), first, limits::screening::tone_prominence)) {
        if (tones.size() >= limits::screening::most_tones) break;
        tones.push_back(seen.refined_hz(peak.cell));
    }
    return tones;
}

RatioCandidates likely_ratios(const Case& looked_at, const std::vector<double>& torque_nm,
                              const std::vector<double>& orders, RatioRange range) {
    const auto samples = counted(looked_at, looked_at.motion.position_deg, torque_nm);
    if (orders.empty() || samples.where.size() < limits::lines::fewest_samples) return {};
    const double highest_order = *std::max_element(orders.begin(), orders.end());
    const LineSpectrum spectrum = spectrum_of(samples, 1.04 * range.highest * highest_order / 360.0);
    // The finest order decides how closely ratios are compared.
    const double step = 0.5 * spectrum.spacing * 360.0 / highest_order;
    // Beyond the spectrum there is nothing to score, however far the joint turned according to a wrong clock.
    const double finest = 2.0 * static_cast<double>(spectrum.power.size()) * highest_order /
                          *std::min_element(orders.begin(), orders.end());
    const auto first = static_cast<std::size_t>(std::min(range.lowest / step, finest));
    const auto last = static_cast<std::size_t>(std::min(range.highest / step, finest));
    std::vector<double> score(last + 1, 0.0);
    for (std::size_t r = first; r <= last; ++r) {
        for (const double order : orders) {
            const double cell = static_cast<double>(r) * step * order / 360.0 / spectrum.spacing;
            const auto k = static_cast<std::size_t>(cell);
            if (k + 1 >= spectrum.power.size()) continue;
            const double part = cell - static_cast<double>(k);
            score[r] += (1.0 - part) * spectrum.power[k] + part * spectrum.power[k + 1];
        }
    }
    std::vector<std::size_t> tops;
    for (std::size_t r = first + 1; r < last; ++r) {
        if (score[r] >= score[r - 1] && score[r] > score[r + 1]) tops.push_back(r);
    }
    std::sort(tops.begin(), tops.end(), [&](std::size_t a, std::size_t b) { return score[a] > score[b]; });
    RatioCandidates found;
    found.compared = static_cast<double>(last - first);
    for (std::size_t i = 0; i < std::min(limits::screening::most_ratios, tops.size()); ++i)
        found.ratios.push_back(static_cast<double>(tops[i]) * step);
    if (!tops.empty()) found.strongest_nm2 = score[tops.front()];
    return found;
}

StatedRipple stated_ripple(const Model& model) {
    StatedRipple ripple{{}, model.gear_ratio};
    Motion scratch;
    for (const Term& term : model.terms) {
        if (term.effect->ripple_order) ripple.orders.push_back(values_of(term)[*term.effect->ripple_order]);
        if (term.effect->change_motion != nullptr)
            term.effect->change_motion(values_of(term), scratch, ripple.ratio);
    }
    return ripple;
}

}  // namespace ripplenotch
