// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>

#include "diagnose/setup/nuisances.hpp"
#include "diagnose/setup/shift_fit.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

bool is_constant(std::span<const double> values) {
    const auto [low, high] = std::minmax_element(values.begin(), values.end());
    return !(*high > *low);
}

// Two fits whose scales differ by more are fits of different things: beside a weight and an inertia of the
// joint, what is left of a simulation that holds nothing else may have any scale.
bool has_like_scale(const SimulationLag& a, const SimulationLag& b) {
    return a.scale * b.scale > 0.0 && std::abs(portable::log(a.scale / b.scale)) <= portable::log(1.5);
}

// The first fit that is identifiable, unless one with more nuisance parameters halves the squares of blocks
// held out at about its scale. The interval reaches to the delays of the others that leave about as little
// and disagree.
SimulationLag chosen_lag(const std::vector<ShiftFit>& fits) {
    const ShiftFit* chosen = &fits.front();
    for (const ShiftFit& fit : fits) {
        if (!fit.lag.identifiable) continue;
        const bool halves = fit.held_out_squares < 0.5 * chosen->held_out_squares;
        if (!chosen->lag.identifiable || (halves && has_like_scale(fit.lag, chosen->lag))) chosen = &fit;
    }
    SimulationLag lag = chosen->lag;
    for (const ShiftFit& fit : fits) {
        const Interval& other = fit.lag.delay_95_s;
        const bool agrees = other.low <= lag.delay_s && lag.delay_s <= other.high;
        if (!fit.lag.identifiable || agrees || fit.held_out_squares > 2.0 * chosen->held_out_squares)
            continue;
        if (!has_like_scale(fit.lag, chosen->lag)) continue;
        lag.delay_95_s.low = std::min(lag.delay_95_s.low, fit.lag.delay_s);
        lag.delay_95_s.high = std::max(lag.delay_95_s.high, fit.lag.delay_s);
    }
    if (lag.identifiable && lag.delay_95_s.high - lag.delay_95_s.low > 2.0 * lag.smoothing_s) {
        lag.identifiable = false;
        lag.reason = too_wide(lag);
    }
    return lag;
}

}  // namespace

SimulationLag lag_by_torque(const TraceView& log, const SimulatedMotion& simulation,
                            std::optional<GearRatio> gear_ratio, const AlignmentOptions& options) {
    SimulationLag none;
    if (log.size() < 8 || simulation.torque_nm.size() < 8) {
        none.reason = "log or simulation has too few torques";
        return none;
    }
    if (is_constant(log.torque_nm) || is_constant(simulation.torque_nm)) {
        none.reason = "the torque of log or simulation is constant";
        return none;
    }
    const double smoothing_s = std::max(
        {options.smoothing.value(), 2.0 * usual_step_s(log.time_s), 2.0 * usual_step_s(simulation.time_s)});
    const SmoothedSeries left(log.time_s, log.torque_nm, smoothing_s),
        right(simulation.time_s, simulation.torque_nm, smoothing_s);
    ShiftProblem problem{
        {}, {}, {}, {right, false}, search_range_s(log.time_s, options), smoothing_s, options.misfit_share};
    problem.at_s = window_times({&left}, smoothing_s);
    for (const double at_s : problem.at_s) problem.target.push_back(left.mean(at_s));
    const NuisanceColumns columns(log, gear_ratio, options, {problem.at_s, smoothing_s});
    const bool has_weight = columns.has_position(), has_load = columns.has_velocity();
    std::vector<ShiftFit> fits;
    const auto try_with = [&](NuisanceChoice choice) {
        choice.friction = choice.ripple = true;
        problem.nuisances = columns.of(choice);
        fits.push_back(fit_shift(problem, options));
    };
    try_with({});
    if (has_load) try_with({.inertia = true});
    if (has_weight) try_with({.inertia = true, .gravity = true});
    if (has_load) try_with({.inertia = true, .load = true});
    if (has_load && has_weight) try_with({.inertia = true, .gravity = true, .load = true});
    return chosen_lag(fits);
}

}  // namespace ripplenotch
