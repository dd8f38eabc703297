// SPDX-License-Identifier: MIT
#include "ripplenotch/filter/map_fit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "filter/map/map_choice.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

constexpr double errors_apart = 3.0;       // by hand: three standard errors
constexpr double ripple_over_noise = 2.0;  ///< squares of an order that is there
constexpr double share_apart = 0.15;       ///< less is no reason to doubt a map

double mean_of(const std::vector<double>& blocks, double unit_nm2) {
    return unit_nm2 * std::accumulate(blocks.begin(), blocks.end(), 0.0);
}

MapOrderScore score_of(double order, const HeldOut& held) {
    MapOrderScore score;
    score.order = order;
    const double there = mean_of(held.there, held.unit_nm2), left = mean_of(held.left, held.unit_nm2);
    const double noise = held.unit_nm2 * held.noise;
    score.ripple_nm = std::sqrt(there);
    score.noise_nm = std::sqrt(noise);
    score.left_nm = std::sqrt(left);
    if (there > noise) score.predicted_share = std::clamp((there - left) / (there - noise), 0.0, 1.0);
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
        const std::complex<double> expected = own.foretold(i, values);
        alike += own.weight(i) * std::conj(expected) * one.windows[i].value[order];
        said += own.weight(i) * std::norm(expected);
    }
    MapAgreement found;
    if (!(said > 0.0)) return found;
    const std::complex<double> factor = alike / said;
    std::vector<std::complex<double>> off(one.blocks);
    for (std::size_t i = 0; i < one.windows.size(); ++i) {
        const std::complex<double> expected = own.foretold(i, values);
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
        for (const std::size_t i : choice.in_map) {
            MapAgreement found = agreement_of(one, others, choice.form, i);
            found.log = l;
            found.order = gear.orders[i].value();
            fit.agreement.push_back(found);
        }
    }
}

// An order whose ripple is there and follows no form stays in the map with no amplitude, for who follows it.
void fill_map(const MapData& data, const MapChoice& choice, const GearAccount& gear, double zero_deg,
              MapFit& fit) {
    fit.map = frame_of(data, choice.form, zero_deg);
    fit.map.gear_ratio = gear.ratio;
    for (std::size_t i = 0; i < data.orders; ++i) {
        MapOrderScore& score = fit.scores[i];
        score.in_map = std::find(choice.in_map.begin(), choice.in_map.end(), i) != choice.in_map.end();
        const double noise = score.noise_nm * score.noise_nm;
        const double left = score.in_map ? score.left_nm * score.left_nm : score.ripple_nm * score.ripple_nm;
        if (!score.in_map && left < ripple_over_noise * noise) continue;
        const MapRegression regression(data, fit.map, i);
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
    for (std::size_t i = 0; i < data.orders; ++i)
        fit.scores.push_back(score_of(gear.orders[i].value(), choice.scores[i]));
    for (std::size_t i = 0; i < data.orders; ++i) {
        fit.notes.push_back(fmt::format("order {}: {:.1f} deviations beyond what logs without ripple show",
                                        shortest(gear.orders[i].value()), choice.beyond[i]));
    }
    fit.finding = choice.in_map.empty() ? MapFinding::nothing : MapFinding::mapped;
    if (fit.finding == MapFinding::mapped) fill_map(data, choice, gear, zero_deg, fit);
    hold_logs_together(data, choice, gear, logs.size(), fit);
    fit.conclusive = fit.anchored && all_agree(fit);
    return fit;
}

}  // namespace ripplenotch
