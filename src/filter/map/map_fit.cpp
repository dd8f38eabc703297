// SPDX-License-Identifier: MIT
#include "ripplenotch/filter/map_fit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "filter/map/map_choice.hpp"
#include "filter/map/map_regression.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

constexpr double errors_apart = 3.0;       // by hand: three standard errors
constexpr double ripple_over_noise = 2.0;  ///< squares of an order that an oscillator may follow
// Squares of an order that is there for certain. The noise of order 1 is measured at 1.5 alone, where a
// spectrum that falls with the third power of the frequency is 11 times smaller.
constexpr double certain_over_noise = 4.0, certain_over_noise_above = 11.0, one_sided_below = 1.1;
constexpr double share_apart = 0.15;  ///< less is no reason to doubt a map

MapOrderScore score_of(double order, const HeldOut& held) {
    MapOrderScore score;
    score.order = order;
    score.ripple_nm = std::sqrt(held.total);
    score.noise_nm = std::sqrt(held.noise);
    score.left_nm = std::sqrt(held.residual);
    if (held.total > held.noise)
        score.predicted_share =
            std::clamp((held.total - held.residual) / (held.total - held.noise), 0.0, 1.0);
    return score;
}

// The factor by which the windows of `one` are what a map of the `others` says, and its error by blocks.
MapAgreement agreement_of(const MapData& one, const MapData& others, const MapForm& form, std::size_t order) {
    const RippleMap frame = frame_of(one, form, 0.0);
    const MapRegression other(others, frame, order), own(one, frame, order);
    const auto values = other.values();
    std::complex<double> alike = 0.0;
    double said = 0.0;
    for (std::size_t i = 0; i < one.windows.size(); ++i) {
        const std::complex<double> expected = own.predicted(i, values);
        alike += own.weight(i) * std::conj(expected) * one.windows[i].value[order];
        said += own.weight(i) * std::norm(expected);
    }
    MapAgreement found;
    if (!(said > 0.0)) return found;
    const std::complex<double> factor = alike / said;
    std::vector<std::complex<double>> off(one.blocks);
    for (std::size_t i = 0; i < one.windows.size(); ++i) {
        const std::complex<double> expected = own.predicted(i, values);
        off[one.windows[i].block] +=
            own.weight(i) * std::conj(expected) * (one.windows[i].value[order] - factor * expected);
    }
    double square = 1.0 / said;  // what noise alone makes of each part
    for (const auto& block : off) square += 0.5 * std::norm(block) / (said * said);
    const double error = std::sqrt(square), size = portable::hypot(factor.real(), factor.imag());
    found.amplitude_ratio = size;
    found.amplitude_error = error;
    // z = A exp(-i phase): a phase that is ahead turns z backward.
    found.phase_deg = -portable::arg(factor) * degrees_per_radian;
    found.phase_error_deg = size > error ? portable::asin(error / size) * degrees_per_radian : 180.0;
    const double apart = portable::hypot(factor.real() - 1.0, factor.imag());
    found.agrees = apart <= std::max(errors_apart * std::numbers::sqrt2 * error, share_apart);
    return found;
}

void hold_logs_together(const MapData& data, const MapChoice& choice, const GearAccount& gear,
                        std::size_t logs, MapFit& fit) {
    for (std::size_t l = 0; logs > 1 && l < logs; ++l) {
        const MapData one = of_log(data, l, true), others = of_log(data, l, false);
        if (one.windows.empty() || others.windows.empty()) continue;
        for (std::size_t i = 0; i < data.orders.size(); ++i) {
            if (!choice.present[i]) continue;
            MapAgreement found = agreement_of(one, others, choice.form, i);
            found.log = l;
            found.order = gear.orders[i].value();
            fit.agreement.push_back(found);
        }
    }
}

bool exceeds_noise(const MapOrderScore& score, double factor) {
    return score.ripple_nm * score.ripple_nm >= factor * score.noise_nm * score.noise_nm;
}

// An order whose ripple is there and follows no form stays in the map with no amplitude, for who follows it.
void fill_map(const MapData& data, const MapChoice& choice, const GearAccount& gear, double zero_deg,
              MapFit& fit) {
    fit.map = frame_of(data, choice.form, zero_deg);
    const RippleMap frame = fit.map;
    fit.map.orders.clear();
    fit.map.gear_ratio = gear.ratio;
    for (std::size_t i = 0; i < data.orders.size(); ++i) {
        const MapOrderScore& score = fit.scores[i];
        if (!score.in_map && !exceeds_noise(score, ripple_over_noise)) continue;
        const double noise = score.noise_nm * score.noise_nm;
        const double left = score.in_map ? score.left_nm * score.left_nm : score.ripple_nm * score.ripple_nm;
        const MapRegression regression(data, frame, i);
        fit.map.orders.push_back(gear.orders[i]);
        fit.map.spread_nm.push_back(std::sqrt(std::max(left - noise, 0.01 * left)));
        fit.errors.push_back(regression.errors());
        fit.map.values.push_back(regression.values());
        if (!score.in_map) fit.map.values.back().assign(choice.form.columns(), 0.0);
    }
}

bool all_agree(const MapFit& fit) {
    return std::all_of(fit.agreement.begin(), fit.agreement.end(),
                       [](const MapAgreement& one) { return one.agrees; });
}

}  // namespace

MapFit fit_ripple_map(std::span<const TraceView> logs, const GearAccount& gear, double zero_deg,
                      std::span<const std::vector<double>> temperatures_degc) {
    if (logs.empty()) raise<UsageError>("a map needs a log");
    MapFit fit;
    fit.anchored =
        std::all_of(logs.begin(), logs.end(), [](const TraceView& log) { return log.has_position(); });
    if (!fit.anchored && logs.size() > 1) {
        raise<DataError>(
            "a log without a position of the joint has no angle that another log shares; map it alone");
    }
    const MapData data = map_data(logs, gear, zero_deg, temperatures_degc);
    fit.windows = data.windows.size();
    fit.blocks = data.blocks;
    fit.map.gear_ratio = gear.ratio;
    fit.map.zero_deg = zero_deg;
    if (fit.windows < fewest_map_windows || gear.orders.empty()) {
        for (const Order order : gear.orders) fit.scores.push_back({order.value()});
        return fit;
    }
    const MapChoice choice = choose_map(data, fit.anchored);
    fit.notes = choice.notes;
    bool any = false, excess = false, bounded = true;
    for (std::size_t i = 0; i < data.orders.size(); ++i) {
        MapOrderScore score = score_of(gear.orders[i].value(), choice.held_out[i]);
        score.in_map = choice.present[i];
        score.false_alarm = choice.false_alarm[i];
        if (!score.in_map) score.detectable_nm = detectable_amplitude(data, i, fit.anchored);
        any = any || score.in_map;
        const double certain = score.order < one_sided_below ? certain_over_noise_above : certain_over_noise;
        excess = excess || exceeds_noise(score, certain);
        bounded = bounded && std::isfinite(score.detectable_nm);
        fit.notes.push_back(fmt::format("order {}: false-alarm probability {:.2g}", shortest(score.order),
                                        score.false_alarm));
        fit.scores.push_back(score);
    }
    // Amplitudes beyond the noise that follow no form tried may be a ripple of another form.
    fit.finding = any ? MapFinding::mapped : excess || !bounded ? MapFinding::unclear : MapFinding::nothing;
    if (any) fill_map(data, choice, gear, zero_deg, fit);
    hold_logs_together(data, choice, gear, logs.size(), fit);
    fit.conclusive = fit.anchored && fit.finding != MapFinding::unclear && all_agree(fit);
    return fit;
}

}  // namespace ripplenotch
