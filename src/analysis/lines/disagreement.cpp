// SPDX-License-Identifier: MIT
#include "analysis/lines/disagreement.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {

namespace {

constexpr double least_spread = 0.1;  // scatter of amplitudes as a share of their mean
// Scatter of amplitudes from run to run of a joint that has not changed.
constexpr double usual_scatter = 0.03;
constexpr double like_speed_share = 0.05;                          // chosen, not derived
constexpr double like_order_share = 0.01, like_ratio_share = 0.1;  // chosen, not derived
constexpr double least_chance = 0.001;         // recordings that agree differ by as much less often than this
constexpr std::size_t fewest_for_scatter = 3;  // recordings: fewer have no median

using Value = Disagreement::Value;

/// Chance that chi-square with so many degrees of freedom is larger: Wilson and Hilferty's cube root.
double chance_of(double chi_square, double freedom) {
    const double spread = 2.0 / (9.0 * freedom);
    const double normal = (portable::cbrt(chi_square / freedom) - (1.0 - spread)) / std::sqrt(spread);
    return 0.5 * std::erfc(normal / std::sqrt(2.0));
}

/// The chance that values which are one differ by as much of their errors.
double chance_of_alike(const std::vector<Value>& values) {
    double top = 0.0, bottom = 0.0, misfit = 0.0;
    for (const Value& one : values) {
        top += one.value / (one.error * one.error);
        bottom += 1.0 / (one.error * one.error);
    }
    for (const Value& one : values) {
        const double off = (one.value - top / bottom) / one.error;
        misfit += off * off;
    }
    return chance_of(misfit, static_cast<double>(values.size()) - 1.0);
}

/// Signed speeds.
bool like_speed(double speed, double other) {
    return std::abs(speed - other) <= like_speed_share * std::abs(other);
}

const Line* same_line(const Identification& one, double order_output) {
    const Line* nearest = nullptr;
    for (const Line& line : one.lines) {
        if (!line.order_output || line.kind == LineKind::tone) continue;
        const double off = std::abs(*line.order_output - order_output);
        if (off > like_order_share * order_output) continue;
        if (nearest == nullptr || off < std::abs(*nearest->order_output - order_output)) nearest = &line;
    }
    return nearest;
}

/// Mean amplitude of a line near a speed, signed, with its error: of noise, or of the scatter where there are
/// enough.
std::optional<Value> amplitude_at(std::size_t recording, const Line& line, double speed_deg_s) {
    double sum = 0.0, noise = 0.0, count = 0.0, square = 0.0;
    for (const AmplitudeAtSpeed& at : line.by_speed) {
        if (!like_speed(at.speed_deg_s, speed_deg_s)) continue;
        // Half of the noise power near a line is in quadrature and changes its phase.
        const double error = at.amplitude_nm / std::max(at.snr, 1.0) / std::sqrt(2.0);
        sum += at.amplitude_nm;
        square += at.amplitude_nm * at.amplitude_nm;
        noise += error * error;
        count += 1.0;
    }
    if (count == 0.0) return std::nullopt;
    const double mean = sum / count;
    double variance = noise / (count * count);
    if (count >= static_cast<double>(fewest_for_scatter))
        variance = std::max(variance, (square / count - mean * mean) / (count - 1.0));
    return Value{recording, mean, portable::hypot(std::sqrt(std::max(variance, 0.0)), usual_scatter * mean)};
}

/// The speeds at which most recordings show the line, and what each of these shows there.
std::vector<Value> amplitudes_at_like_speed(std::span<const Identification> each, double order_output) {
    std::vector<Value> best;
    for (const Identification& one : each) {
        const Line* line = same_line(one, order_output);
        if (line == nullptr) continue;
        for (const AmplitudeAtSpeed& at : line->by_speed) {
            std::vector<Value> values;
            for (std::size_t i = 0; i < each.size(); ++i) {
                const Line* other = same_line(each[i], order_output);
                if (other == nullptr) continue;
                if (const auto value = amplitude_at(i, *other, at.speed_deg_s)) values.push_back(*value);
            }
            if (values.size() > best.size()) best = std::move(values);
        }
    }
    return best;
}

std::optional<Disagreement> about_amplitude(const Line& line, std::span<const Identification> each) {
    std::vector<Value> values = amplitudes_at_like_speed(each, *line.order_output);
    if (values.size() < 2) return std::nullopt;
    const auto by_value = [](const Value& a, const Value& b) { return a.value < b.value; };
    const auto [least, most] = std::minmax_element(values.begin(), values.end(), by_value);
    const double chance = chance_of_alike(values);
    if (chance > least_chance || most->value < (1.0 + least_spread) * least->value) return std::nullopt;
    return Disagreement{Disagreement::About::amplitude, line.order, line.order_output, std::move(values),
                        chance};
}

/// Compares ratios near the common one only: half of it is another interpretation of the same lines.
std::optional<Disagreement> about_ratio(const Identification& together,
                                        std::span<const Identification> each) {
    std::vector<Value> values;
    if (!together.gear_ratio.value) return std::nullopt;
    const double common = *together.gear_ratio.value;
    for (std::size_t i = 0; i < each.size(); ++i) {
        const GearRatioFit& fit = each[i].gear_ratio;
        if (fit.value && std::abs(*fit.value - common) < like_ratio_share * common)
            values.push_back({i, *fit.value, std::max(0.25 * (fit.ci95_high - fit.ci95_low), 1e-9)});
    }
    if (values.size() < 2) return std::nullopt;
    const double chance = chance_of_alike(values);
    if (chance > least_chance) return std::nullopt;
    return Disagreement{Disagreement::About::ratio, {}, {}, std::move(values), chance};
}

}  // namespace

std::vector<Disagreement> disagreements(const Identification& together,
                                        std::span<const Identification> each) {
    std::vector<Disagreement> found;
    if (each.size() < 2) return found;
    if (auto ratio = about_ratio(together, each)) found.push_back(std::move(*ratio));
    for (const Line& line : together.lines) {
        if (!line.order_output || line.kind == LineKind::tone) continue;
        if (auto amplitude = about_amplitude(line, each)) found.push_back(std::move(*amplitude));
    }
    return found;
}

}  // namespace ripplenotch
