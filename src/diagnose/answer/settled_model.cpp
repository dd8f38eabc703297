// SPDX-License-Identifier: MIT
#include "diagnose/answer/settled_model.hpp"

#include <algorithm>
#include <cmath>

#include "core/matrices/factorisations.hpp"
#include "core/matrices/least_squares.hpp"
#include "core/vectors/dot.hpp"
#include "ripplenotch/model/motion.hpp"

namespace ripplenotch {
namespace {

// Blocks of the sandwich errors: longer than what smoothing ties together, several to a move.
constexpr double error_stretch_s = 0.25;
// Samples within so long are one measurement of a slowly changing column.
constexpr double memory_s = 0.2;
// Model and uncertain factors are fitted in turn: an arm's masses move a friction by less than its error.
constexpr int turns = 6;

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

// A step of the uncertain factors towards the residual, against their priors.
void move_departure(SettledModel& found, const LogAlong& log, double noise_nm) {
    const std::size_t count = log.uncertain_nm.size();
    std::vector<std::vector<double>> columns;
    for (const std::vector<double>& column : log.uncertain_nm) {
        columns.push_back(sensed_nm(found.model, log.motion, column));
        for (std::size_t k = 0; k < log.size(); ++k) columns.back()[k] *= log.use[k];
    }
    const double left_nm = std::max(noise_nm, rms_where(found.residual_nm, log.use));
    const double weight =
        1.0 / (left_nm * left_nm * std::max(memory_s * log.motion.sample_rate.value(), 1.0));
    const auto size = static_cast<Eigen::Index>(count);
    Eigen::MatrixXd products(size, size);
    Eigen::VectorXd side(size);
    for (std::size_t a = 0; a < count; ++a) {
        const auto i = static_cast<Eigen::Index>(a);
        const double prior = 1.0 / (log.deviation[a] * log.deviation[a]);
        for (std::size_t b = 0; b <= a; ++b) {
            const auto j = static_cast<Eigen::Index>(b);
            products(i, j) = products(j, i) =
                weight * dot(columns[a].data(), columns[b].data(), log.size()) + (a == b ? prior : 0.0);
        }
        side[i] = weight * dot(columns[a].data(), found.residual_nm.data(), log.size()) -
                  prior * found.departure[a];
    }
    const ScaledDefiniteFactors factors(products, 1e-12);
    const Eigen::VectorXd step = factors.solve(side), variance = factors.inverse_diagonal();
    for (std::size_t a = 0; a < count; ++a) {
        found.departure[a] += step[static_cast<Eigen::Index>(a)];
        found.departure_error[a] = std::sqrt(std::max(variance[static_cast<Eigen::Index>(a)], 0.0));
    }
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

SettledModel settled(const Model& open, const LogAlong& log, double noise_nm,
                     std::span<const double> departure, const Model* first_guess) {
    SettledModel found;
    found.departure.assign(departure.begin(), departure.end());
    found.departure.resize(log.uncertain_nm.size(), 0.0);
    found.departure_error.assign(log.uncertain_nm.size(), 0.0);
    if (departure.empty() && !log.uncertain_nm.empty()) {
        found.model.gear_ratio = open.gear_ratio;
        found.residual_nm = residual_along(found.model, log, {});
        move_departure(found, log, noise_nm);
    }
    const auto stretch =
        static_cast<std::size_t>(std::max(error_stretch_s * log.motion.sample_rate.value(), 1.0));
    for (int turn = 0; turn < turns; ++turn) {
        const Motion motion = with_departure(log, found.departure);
        Fit fitted = fit(open, motion, log.torque_nm,
                         {.first_guess = first_guess, .use = log.use, .error_stretch = stretch});
        found.model = std::move(fitted.model);
        found.values = std::move(fitted.values);
        found.residual_nm = left_of(found.model, motion, log);
        if (log.uncertain_nm.empty()) break;
        if (turn + 1 < turns) move_departure(found, log, noise_nm);
    }
    return found;
}

double rms_where(std::span<const double> values, std::span<const unsigned char> use) {
    double sum = 0.0, count = 0.0;
    for (std::size_t k = 0; k < values.size(); ++k) {
        if (use[k] == 0) continue;
        sum += values[k] * values[k];
        count += 1.0;
    }
    return count > 0.0 ? std::sqrt(sum / count) : 0.0;
}

std::vector<GivenValue> values_of_given(std::span<const GivenTerm> given, const SettledModel& found) {
    std::vector<GivenValue> reported;
    std::size_t next = 0;
    for (const GivenTerm& term : given) {
        for (std::size_t i = 0; i < term.mean.size(); ++i) {
            GivenValue value{term.name, term.mean[i], std::nullopt};
            if (is_uncertain(term, i)) {
                value.value += found.departure[next];
                const double half = normal_95_errors * found.departure_error[next++];
                value.ci95 = Interval{value.value - half, value.value + half};
            }
            reported.push_back(std::move(value));
        }
    }
    return reported;
}

}  // namespace ripplenotch
