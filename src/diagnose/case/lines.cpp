// SPDX-License-Identifier: MIT
#include "diagnose/case/lines.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "diagnose/case/tones.hpp"
#include "ripplenotch/analysis/fourier.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
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

// Against the angle each stretch of it counts the same, however long the joint stayed there: rests and slow
// passes would spread a line over its whole neighbourhood.
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

double highest_cycles_per_deg(const Case& c, const LineRules& rules) {
    // Order 8.6 of a hundredfold gear, or what the sampling resolves at moderate speed: beyond, noise alone.
    double fastest = 0.0;
    for (const double v : c.motion.velocity_deg_s) fastest = std::max(fastest, std::abs(v));
    return 0.5 * c.motion.sample_rate.value() / std::max(rules.moderate_speed * fastest, 1.0);
}

struct Peak {
    std::size_t cell;
    double prominence;
};

std::vector<Peak> peaks_of(const LineSpectrum& spectrum, std::size_t first, double least,
                           const LineRules& rules) {
    const auto floor = background(spectrum.power, rules.background_cells);
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
                     const LineRules& rules, std::vector<ResidualLine>& lines) {
    const LineSamples samples = evenly_by_angle(c, residual_nm);
    if (samples.where.size() < rules.fewest_samples || !(range_of(samples) > rules.least_range)) return;
    const LineSpectrum spectrum = spectrum_of(samples, highest_cycles_per_deg(c, rules), rules);
    // Slow orders are matters of gravity and friction.
    const auto first = static_cast<std::size_t>(rules.fewest_cycles_per_turn / 360.0 / spectrum.spacing) + 1;
    for (const Peak& peak : peaks_of(spectrum, first, least, rules)) {
        const double cell = static_cast<double>(peak.cell) * spectrum.spacing;
        lines.push_back(
            {true, refine_peak(samples.where, samples.value, {.frequency = cell, .reach = spectrum.spacing}),
             std::sqrt(spectrum.power[peak.cell]), peak.prominence});
        if (lines.size() > rules.most_peaks) break;
    }
}

void gather_by_time(const Case& c, const std::vector<double>& residual_nm, double least,
                    const LineRules& rules, std::vector<ResidualLine>& lines) {
    LineSamples samples = counted(c, c.motion.time_s, residual_nm);
    if (samples.where.size() < rules.fewest_samples || !(range_of(samples) > rules.least_range)) return;
    const Tones tones(std::move(samples), c.motion.sample_rate.value(), rules);
    // Slow tones are matters of drift.
    const auto first = static_cast<std::size_t>(rules.slowest_tone_hz / tones.spectrum().spacing) + 1;
    for (const Peak& peak : peaks_of(tones.spectrum(), first, least, rules)) {
        lines.push_back({false, tones.refined_hz(peak.cell), std::sqrt(tones.spectrum().power[peak.cell]),
                         peak.prominence});
        if (lines.size() > rules.most_peaks) break;
    }
}

}  // namespace

std::vector<ResidualLine> standing_out(const Case& looked_at, const std::vector<double>& residual_nm,
                                       double least, std::size_t most, const LineRules& rules) {
    std::vector<ResidualLine> lines, by_angle;
    gather_by_time(looked_at, residual_nm, least, rules, lines);
    gather_by_angle(looked_at, residual_nm, least, rules, by_angle);
    lines.insert(lines.end(), by_angle.begin(), by_angle.end());
    std::sort(lines.begin(), lines.end(),
              [](const ResidualLine& a, const ResidualLine& b) { return a.prominence > b.prominence; });
    if (lines.size() > most) lines.resize(most);
    return lines;
}

std::vector<double> strongest_tones_hz(const Case& looked_at, const std::vector<double>& residual_nm,
                                       const DiagnosisRules& rules) {
    LineSamples samples = counted(looked_at, looked_at.motion.time_s, residual_nm);
    if (samples.where.size() < rules.lines.fewest_samples) return {};
    const Tones seen(std::move(samples), looked_at.motion.sample_rate.value(), rules.lines);
    const auto first = static_cast<std::size_t>(rules.lines.slowest_tone_hz / seen.spectrum().spacing) + 1;
    std::vector<double> tones;
    for (const Peak& peak : peaks_of(seen.spectrum(), first, rules.screening.tone_prominence, rules.lines)) {
        if (tones.size() >= rules.screening.most_tones) break;
        tones.push_back(seen.refined_hz(peak.cell));
    }
    return tones;
}

RatioCandidates likely_ratios(const Case& looked_at, const std::vector<double>& torque_nm,
                              const std::vector<double>& orders, RatioRange range,
                              const DiagnosisRules& rules) {
    const auto samples = counted(looked_at, looked_at.motion.position_deg, torque_nm);
    if (orders.empty() || samples.where.size() < rules.lines.fewest_samples) return {};
    const double highest_order = *std::max_element(orders.begin(), orders.end());
    const LineSpectrum spectrum =
        spectrum_of(samples, 1.04 * range.highest * highest_order / 360.0, rules.lines);
    // The finest order decides how closely ratios are compared.
    const double step = 0.5 * spectrum.spacing * 360.0 / highest_order;
    // Beyond the spectrum there is nothing to score, however far a clock that is wrong says that the joint
    // turned.
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
    for (std::size_t i = 0; i < std::min(rules.screening.most_ratios, tops.size()); ++i)
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
