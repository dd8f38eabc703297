// SPDX-License-Identifier: MIT
#include "analysis/motion/velocity_error.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "analysis/motion/velocity_noise.hpp"
#include "analysis/motion/velocity_power.hpp"
#include "core/matrices/factorisations.hpp"

namespace ripplenotch {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
constexpr std::size_t most_orders = 4;   // by hand: the clearest say nearly all
constexpr double offset_share = 0.01;    // by hand, of the fastest speed: a poor tachometer's
constexpr double likely_delay_s = 0.02;  // by hand: a velocity filter of 8 Hz is as late
constexpr int most_climbing_steps = 40;  // by hand; four to eight are usual

/// The maximum next to a start, by scored steps that are shortened until the power rises (Levenberg).
VectorXd climbed(const RipplePower& power, VectorXd unknown) {
    RipplePower::At here = power.at(unknown);
    double damping = 1e-3;
    for (int step = 0; step < most_climbing_steps && damping < 1e9; ++step) {
        MatrixXd bent = here.expected;
        bent.diagonal() *= 1.0 + damping;
        const VectorXd move = SymmetricFactors(bent).solve(here.slope);
        RipplePower::At there = power.at(unknown + move);
        if (!(there.value > here.value)) {
            damping *= 8.0;
            continue;
        }
        const bool done = there.value - here.value < 1e-9 * there.value;
        unknown += move;
        here = std::move(there);
        damping = std::max(1e-6, 0.2 * damping);
        if (done) break;
    }
    return unknown;
}

/// From one deviation to either side as well: a line of a high order has more than one maximum in reach.
VectorXd best_of_starts(const RipplePower& power, const VelocityError& beforehand) {
    VectorXd best = climbed(power, VectorXd::Zero(power.unknowns()));
    double most = power.at(best).value;
    for (const auto& [offset, delay] : {std::pair{-1.0, 0.0}, {1.0, 0.0}, {0.0, -1.0}, {0.0, 1.0}}) {
        VectorXd start = VectorXd::Zero(power.unknowns());
        start[power.offset()] = offset * beforehand.offset_error.value();
        start[power.delay()] = delay * beforehand.delay_error.value();
        const VectorXd end = climbed(power, std::move(start));
        const double value = power.at(end).value;
        if (value > most + 1e-6) {
            most = value;
            best = end;
        }
    }
    return best;
}

double deviation(const MatrixXd& covariance, Eigen::Index one) { return std::sqrt(covariance(one, one)); }

}  // namespace

std::optional<VelocityFit> fit_velocity_error(std::span<const TraceView> logs, std::span<const Sweep> sweeps,
                                              const Stack& angle, std::span<const double> orders) {
    orders = orders.first(std::min(orders.size(), most_orders));
    double fastest = 0.0;
    std::vector<double> noise_of_log;
    for (const TraceView& log : logs) noise_of_log.push_back(log.has_position() ? 0.0 : velocity_noise(log));
    std::vector<DemodulatedSweep> all;
    for (std::size_t i = 0; i < sweeps.size(); ++i) {
        const Sweep& sweep = sweeps[i];
        fastest = std::max(fastest, sweep.fast_deg_s);
        for (std::size_t n = 0; n < orders.size(); ++n) {
            const auto bin = static_cast<std::size_t>(std::lround(orders[n] / angle.spacing));
            const auto& floors = angle.floors[i];
            if (bin >= floors.size() || !(floors[bin] > 0.0F)) continue;
            all.push_back(demodulated(logs[sweep.log], sweep, orders[n]));
            all.back().sweep = i;
            all.back().order = n;
            all.back().noise = static_cast<double>(floors[bin]);
            all.back().variance_per_s = noise_of_log[sweep.log] / (360.0 * 360.0);
        }
    }
    if (all.empty()) return std::nullopt;
    const VelocityError beforehand{{}, DegPerSec(offset_share * fastest), {}, Seconds(likely_delay_s)};
    const RipplePower power(std::move(all), orders.size(), beforehand);
    const VectorXd best = best_of_starts(power, beforehand);
    const RipplePower::At top = power.at(best);
    const MatrixXd stiffness = -top.curve;
    const SymmetricFactors factors(stiffness);
    if (!(factors.least_pivot() > 0.0)) return std::nullopt;
    const RipplePower::SlopeVariance slopes = power.slope_variance(best);
    const auto between = [&](const MatrixXd& variance) {
        return factors.solve(MatrixXd(factors.solve(variance).transpose()));
    };
    const MatrixXd own = between(slopes.own), common = between(slopes.common), covariance = own + common;
    VelocityFit fit;
    fit.error = {DegPerSec(best[power.offset()]), DegPerSec(deviation(covariance, power.offset())),
                 Seconds(best[power.delay()]), Seconds(deviation(covariance, power.delay()))};
    // At steady speeds the lines say nothing of a delay: what was supposed beforehand is no finding.
    constexpr double told_share = 0.7;  // by hand: of the error beforehand
    fit.error.delay_told = fit.error.delay_error.value() < told_share * likely_delay_s;
    fit.order_shares.assign(best.begin(), best.begin() + static_cast<Eigen::Index>(orders.size()));
    fit.most_cycles = power.most_cycles(best);
    // Of the clearest order, what noise of the torque would not leave if the other unknowns were known.
    const double alone = slopes.own(0, 0) / (stiffness(0, 0) * stiffness(0, 0));
    fit.order_share_error = std::sqrt(common(0, 0) + std::max(0.0, own(0, 0) - alone));
    return fit;
}

}  // namespace ripplenotch
