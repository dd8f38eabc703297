// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>

#include "diagnose/setup/shift_fit.hpp"

namespace ripplenotch {
namespace {

double travel_of(std::span<const double> values) {
    const auto [low, high] = std::minmax_element(values.begin(), values.end());
    return *high - *low;
}

// One motion: the series that its velocity is taken from.
struct MotionSeries {
    std::span<const double> value;
    bool is_position = false;
};

// The same series of both, if there is one: a velocity of the log may have passed a filter that its position
// has not.
std::pair<MotionSeries, MotionSeries> chosen_series(const TraceView& log, const SimulatedMotion& simulation) {
    const bool both_velocities = !log.velocity_deg_s.empty() && !simulation.velocity_deg_s.empty();
    const bool log_position = log.has_position() && (!simulation.position_deg.empty() || !both_velocities);
    const bool simulated_position =
        !simulation.position_deg.empty() && (log.has_position() || !both_velocities);
    return {log_position ? MotionSeries{log.position_deg, true} : MotionSeries{log.velocity_deg_s, false},
            simulated_position ? MotionSeries{simulation.position_deg, true}
                               : MotionSeries{simulation.velocity_deg_s, false}};
}

SeriesAgreement agreement_of(const SmoothedSeries& log, const SmoothedSeries& simulation,
                             const SimulationLag& lag) {
    SeriesAgreement agreement;
    std::vector<double> left, right;
    for (const double at_s : window_times({&log}, lag.smoothing_s)) {
        const double other_s = at_s - lag.delay_s - lag.clock_error.value_or(0.0) * (at_s - lag.middle_s);
        if (!simulation.covers(other_s)) continue;
        left.push_back(log.mean(at_s));
        right.push_back(simulation.mean(other_s));
    }
    if (left.empty()) return agreement;
    const auto count = static_cast<double>(left.size());
    double mean_left = 0.0, mean_right = 0.0, squares_left = 0.0, squares_right = 0.0, products = 0.0,
           differences = 0.0;
    for (std::size_t k = 0; k < left.size(); ++k) {
        mean_left += left[k] / count;
        mean_right += right[k] / count;
        differences += (left[k] - right[k]) * (left[k] - right[k]) / count;
    }
    for (std::size_t k = 0; k < left.size(); ++k) {
        squares_left += (left[k] - mean_left) * (left[k] - mean_left);
        squares_right += (right[k] - mean_right) * (right[k] - mean_right);
        products += (left[k] - mean_left) * (right[k] - mean_right);
    }
    const double both = std::sqrt(squares_left * squares_right);
    agreement.correlation = both > 0.0 ? products / both : 0.0;
    agreement.scale = squares_right > 0.0 ? products / squares_right : 0.0;
    agreement.offset = mean_left - agreement.scale * mean_right;
    agreement.rms_difference = std::sqrt(differences);
    agreement.travel = travel_of(left);
    return agreement;
}

}  // namespace

SimulationLag lag_by_motion(const TraceView& log, const SimulatedMotion& simulation,
                            const AlignmentOptions& options) {
    SimulationLag none;
    if (!simulation.has_motion() || (!log.has_position() && log.velocity_deg_s.empty())) {
        none.reason = "log or simulation has neither position nor velocity";
        return none;
    }
    if (std::min(log.time_s.size(), simulation.time_s.size()) < 8) {
        none.reason = "log or simulation has too few samples";
        return none;
    }
    const auto [measured, simulated] = chosen_series(log, simulation);
    if (!(travel_of(measured.value) > 0.0) || !(travel_of(simulated.value) > 0.0)) {
        none.reason = "the joint does not move in the log or in the simulation";
        return none;
    }
    const double smoothing_s = std::max(
        {options.smoothing.value(), 2.0 * usual_step_s(log.time_s), 2.0 * usual_step_s(simulation.time_s)});
    const SmoothedSeries left(log.time_s, measured.value, smoothing_s),
        right(simulation.time_s, simulated.value, smoothing_s);
    ShiftProblem problem{{}, {}, {}, {right, simulated.is_position}, 0.0, smoothing_s};
    problem.range_s = search_range_s(log.time_s, options);
    problem.at_s = window_times({&left}, smoothing_s);
    const SmoothedSignal velocity{left, measured.is_position};
    for (const double at_s : problem.at_s) problem.target.push_back(velocity.value(at_s));
    problem.nuisances = {std::vector<double>(problem.at_s.size(), 1.0)};
    SimulationLag lag = fit_shift(problem, options).lag;
    if (log.has_position() && !simulation.position_deg.empty())
        lag.position = agreement_of({log.time_s, log.position_deg, smoothing_s},
                                    {simulation.time_s, simulation.position_deg, smoothing_s}, lag);
    if (!log.velocity_deg_s.empty() && !simulation.velocity_deg_s.empty())
        lag.velocity = agreement_of({log.time_s, log.velocity_deg_s, smoothing_s},
                                    {simulation.time_s, simulation.velocity_deg_s, smoothing_s}, lag);
    return lag;
}

}  // namespace ripplenotch
