// SPDX-License-Identifier: MIT
#include "diagnose/answer/answer.hpp"

#include <algorithm>
#include <cmath>

#include "core/matrices/least_squares.hpp"
#include "core/vectors/dot.hpp"
#include "ripplenotch/model/motion.hpp"

namespace ripplenotch {
namespace {

// Blocks of the sandwich errors: longer than what smoothing ties together, several to a move.
constexpr double error_stretch_s = 0.25;

// The scale of a simulation is a question for the effect `simulation-scale`.
bool is_uncertain(const GivenTerm& term, std::size_t value) {
    return term.name != "simulated" && term.deviation[value] > stated_deviation;
}

Motion with_departure(const LogAlong& log, std::span<const double> departure) {
    Motion motion = log.motion;
    for (std::size_t c = 0; c < departure.size(); ++c)
        add_scaled(departure[c], log.uncertain_nm[c].data(), motion.known_nm.data(), log.size());
    return motion;
}

std::vector<double> left_of(const Model& stated, const Motion& motion, const LogAlong& log) {
    std::vector<double> residual_nm = predict_nm(stated, motion);
    for (std::size_t k = 0; k < residual_nm.size(); ++k) residual_nm[k] = log.torque_nm[k] - residual_nm[k];
    return residual_nm;
}

}  // namespace

LogAlong log_along(const TraceView& log, std::span<const GivenTerm> given, Seconds smoothing) {
    LogAlong along;
    along.motion = motion_along(log, smoothing);
    for (const double torque : log.torque_nm) {
        along.use.push_back(std::isfinite(torque) ? 1 : 0);
        along.torque_nm.push_back(std::isfinite(torque) ? torque : 0.0);
    }
    if (!given.empty()) along.motion.known_nm.assign(log.size(), 0.0);
    for (const GivenTerm& term : given) {
        for (std::size_t i = 0; i < term.torque_nm.size(); ++i) {
            add_scaled(term.mean[i], term.torque_nm[i].data(), along.motion.known_nm.data(), log.size());
            if (!is_uncertain(term, i)) continue;
            along.uncertain_nm.push_back(term.torque_nm[i]);
            along.deviation.push_back(term.deviation[i]);
        }
    }
    return along;
}

std::vector<double> residual_along(const Model& stated, const LogAlong& log,
                                   std::span<const double> departure) {
    return left_of(stated, with_departure(log, departure), log);
}

SettledModel settled(const Model& open, const LogAlong& log, std::span<const double> departure,
                     const Model* first_guess) {
    const Motion motion = with_departure(log, departure);
    const auto stretch =
        static_cast<std::size_t>(std::max(error_stretch_s * log.motion.sample_rate.value(), 1.0));
    Fit fitted = fit(open, motion, log.torque_nm,
                     {.first_guess = first_guess, .use = log.use, .error_stretch = stretch});
    SettledModel found{
        std::move(fitted.model), std::move(fitted.values), {departure.begin(), departure.end()}, {}};
    found.residual_nm = left_of(found.model, motion, log);
    return found;
}

std::vector<GivenValue> values_of_given(std::span<const GivenTerm> given, std::span<const double> departure,
                                        std::span<const double> errors) {
    std::vector<GivenValue> reported;
    std::size_t next = 0;
    for (const GivenTerm& term : given) {
        for (std::size_t i = 0; i < term.mean.size(); ++i) {
            GivenValue value{term.name, term.mean[i], std::nullopt};
            if (is_uncertain(term, i) && next < departure.size()) {
                value.value += departure[next];
                const double half = normal_95_errors * errors[next++];
                value.ci95 = Interval{value.value - half, value.value + half};
            }
            reported.push_back(std::move(value));
        }
    }
    return reported;
}

}  // namespace ripplenotch
