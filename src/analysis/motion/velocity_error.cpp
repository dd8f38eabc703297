// SPDX-License-Identifier: MIT
#include "analysis/motion/velocity_error.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "core/functions/many_numbers.hpp"
#include "core/matrices/factorisations.hpp"
#include "core/matrices/linear_algebra.hpp"
#include "core/rows/row_facts.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using Complex = std::complex<double>;

/// A sweep's torque at one order: demodulated, and averaged over short cells. The two columns are the
/// derivatives of the angle with respect to the order's own position and the offset, in turns for one unit
/// of each, about their means.
struct DemodulatedSweep {
    std::size_t sweep = 0, order = 0;  ///< which
    double cycles = 0.0;               ///< per turn
    double noise = 0.0;                ///< power of it in the sum
    std::vector<std::complex<double>> value;
    std::vector<double> weight, weight_square, seconds;
    std::array<std::vector<double>, 2> column;
    /// Variance of the angle, in turns^2, from the integrated noise of the velocity.
    double variance_per_s = 0.0;
    double weights = 0.0, weight_squares = 0.0;
};

/// Half of the summed power over noise at some values of the unknowns: one for each order (its position, as a
/// share), then the offset in deg/s. Includes the prior of the unknowns.
class RipplePower {
  public:
    /// `likely_offset`: how far the offset may be from 0.
    RipplePower(std::vector<DemodulatedSweep> all, std::size_t orders, DegPerSec likely_offset)
        : all_(std::move(all)),
          orders_(orders),
          certainty_(Eigen::VectorXd::Zero(static_cast<Eigen::Index>(orders) + 1)) {
        certainty_[offset()] = 1.0 / (likely_offset.value() * likely_offset.value());
    }

    struct At {
        double value = 0.0;
        Eigen::VectorXd slope;
        /// What its second derivative is expected to be, less its sign, where the cells are in phase: never
        /// indefinite.
        Eigen::MatrixXd expected;
    };

    [[nodiscard]] Eigen::Index unknowns() const { return static_cast<Eigen::Index>(orders_) + 1; }
    [[nodiscard]] Eigen::Index offset() const { return static_cast<Eigen::Index>(orders_); }

    [[nodiscard]] At at(const Eigen::VectorXd& unknown) const {
        At sum{-0.5 * unknown.dot(certainty_.cwiseProduct(unknown)), -certainty_.cwiseProduct(unknown),
               Eigen::MatrixXd(certainty_.asDiagonal())};
        for (const DemodulatedSweep& cells : all_) add(cells, unknown, sum);
        return sum;
    }

    /// Covariance of the slope at the maximum: from noise of the torque, and from the common sources of all
    /// orders, noise of the velocity and the prior.
    struct SlopeVariance {
        Eigen::MatrixXd own, common;
    };
    [[nodiscard]] SlopeVariance slope_variance(const Eigen::VectorXd& unknown) const;

    /// How far the offset moves a cell within its sweep, at most, in cycles of its order.
    [[nodiscard]] double most_cycles(const Eigen::VectorXd& unknown) const;

  private:
    [[nodiscard]] std::array<Eigen::Index, 2> places_of(const DemodulatedSweep& cells) const {
        return {static_cast<Eigen::Index>(cells.order), offset()};
    }

    void add(const DemodulatedSweep& cells, const Eigen::VectorXd& unknown, At& sum) const;

    std::vector<DemodulatedSweep> all_;
    std::size_t orders_;
    Eigen::VectorXd certainty_;
};

// So many of a sweep turn less than a tenth of a cycle each where the whole is wrong by five cycles.
constexpr std::size_t cells_per_sweep = 48;

void centre(DemodulatedSweep& cells) {
    for (std::vector<double>& column : cells.column) {
        double mean = 0.0;
        for (std::size_t i = 0; i < column.size(); ++i) mean += cells.weight[i] * column[i] / cells.weights;
        for (double& one : column) one -= mean;
    }
}

struct PowerMoments {
    Complex value;
    std::array<Complex, 2> first{};
};

/// The sum and its slopes by the two unknowns that move it.
PowerMoments power_moments(const DemodulatedSweep& cells, const std::array<double, 2>& moved) {
    PowerMoments sum;
    const double rate = full_turn * cells.cycles;
    for (std::size_t i = 0; i < cells.value.size(); ++i) {
        const double off = moved[0] * cells.column[0][i] + moved[1] * cells.column[1][i];
        const Complex z = cells.value[i] * portable::polar(1.0, -rate * off);
        sum.value += z;
        for (std::size_t a = 0; a < 2; ++a) sum.first[a] += Complex(0.0, -rate * cells.column[a][i]) * z;
    }
    return sum;
}

/// Sums of weight * column a * column b over the cells.
double spread_of_cells(const DemodulatedSweep& cells, const std::vector<double>& weight, std::size_t a,
                       std::size_t b) {
    double sum = 0.0;
    for (std::size_t i = 0; i < weight.size(); ++i)
        sum += weight[i] * cells.column[a][i] * cells.column[b][i];
    return sum;
}

/// `noise` and `variance_per_s` are left to the caller. Cost O(samples).
DemodulatedSweep demodulated(const TraceView& log, const Sweep& sweep, double cycles_per_turn) {
    const std::size_t n = sweep.turns.size(), count = std::min(n, cells_per_sweep);
    DemodulatedSweep cells;
    cells.cycles = cycles_per_turn;
    for (std::size_t i = 0; i < count; ++i) {
        const std::size_t first = n * i / count, end = n * (i + 1) / count;
        Complex sum;
        double weight = 0.0, squares = 0.0, turns = 0.0, time = 0.0;
        for (std::size_t k = first; k < end; ++k) {
            sum += sweep.value[k] * portable::polar(1.0, -full_turn * cycles_per_turn * sweep.turns[k]);
            weight += sweep.weight[k];
            squares += sweep.weight[k] * sweep.weight[k];
            turns += sweep.turns[k];
            time += sweep.time_s[k];
        }
        const auto samples = static_cast<double>(end - first);
        cells.value.push_back(sum);
        cells.weight.push_back(weight);
        cells.weight_square.push_back(squares);
        cells.weights += weight;
        cells.weight_squares += squares;
        cells.seconds.push_back(samples / sweep.rate_hz);
        cells.column[0].push_back(turns / samples);
        cells.column[1].push_back(log.has_position() ? 0.0 : -time / samples / 360.0);
    }
    centre(cells);
    return cells;
}

void RipplePower::add(const DemodulatedSweep& cells, const VectorXd& unknown, At& sum) const {
    const auto place = places_of(cells);
    const PowerMoments m = power_moments(cells, {unknown[place[0]], unknown[place[1]]});
    const double power = std::norm(m.value) / cells.noise;
    sum.value += 0.5 * power;
    const double rate = full_turn * cells.cycles;
    const double stiff = power / cells.weights * rate * rate;
    for (std::size_t a = 0; a < 2; ++a) {
        sum.slope[place[a]] += std::real(std::conj(m.value) * m.first[a]) / cells.noise;
        for (std::size_t b = 0; b < 2; ++b)
            sum.expected(place[a], place[b]) += stiff * spread_of_cells(cells, cells.weight, a, b);
    }
}

double RipplePower::most_cycles(const VectorXd& unknown) const {
    double most = 0.0;
    for (const DemodulatedSweep& cells : all_) {
        for (std::size_t i = 0; i < cells.value.size(); ++i) {
            most = std::max(most, cells.cycles * std::abs(unknown[offset()] * cells.column[1][i]));
        }
    }
    return most;
}

RipplePower::SlopeVariance RipplePower::slope_variance(const VectorXd& unknown) const {
    SlopeVariance variance{MatrixXd::Zero(unknowns(), unknowns()), MatrixXd(certainty_.asDiagonal())};
    std::vector<VectorXd> after;  // by cell, how much of the slope one turn of angle from there on makes
    const DemodulatedSweep* before = nullptr;
    const auto settle = [&] {
        if (before == nullptr) return;
        for (std::size_t i = 0; i < after.size(); ++i)
            variance.common += before->variance_per_s * before->seconds[i] * after[i] * after[i].transpose();
        after.clear();
    };
    for (const DemodulatedSweep& cells : all_) {
        // The orders of one sweep follow each other, and share its angle.
        if (before != nullptr && before->sweep != cells.sweep) settle();
        before = &cells;
        after.resize(cells.value.size(), VectorXd::Zero(unknowns()));
        const auto place = places_of(cells);
        const PowerMoments m = power_moments(cells, {unknown[place[0]], unknown[place[1]]});
        const double power = std::max(0.0, std::norm(m.value) / cells.noise - 1.0);
        const double rate = full_turn * cells.cycles, stiff = power / cells.weights * rate * rate;
        for (std::size_t a = 0; a < 2; ++a) {
            double tail = 0.0;
            for (std::size_t i = cells.value.size(); i-- > 0;) {
                tail += cells.weight[i] * cells.column[a][i];
                after[i][place[a]] += stiff * tail;
            }
            for (std::size_t b = 0; b < 2; ++b) {
                variance.own(place[a], place[b]) += 0.5 * power * rate * rate *
                                                    spread_of_cells(cells, cells.weight_square, a, b) /
                                                    cells.weight_squares;
            }
        }
    }
    settle();
    return variance;
}

/// Where a velocity in coarse steps turns, it stays at one value while the joint is up to a step away: a
/// parabola that reaches a share h of the step, anything from 0 to 1, has a mean error of 2 h / 3 - 1 / 2.
constexpr double square_off = 1.0 / 27.0 + 1.0 / 36.0;
constexpr std::size_t fewest_alike = 3;  // chosen, not derived: noise alone makes two alike now and then
// Chosen, not derived: share of a step; values have been rounded in other units.
constexpr double same_step = 1e-3;

/// Variance that turning points of a velocity in steps add to its sum in each second, in deg^2/s. Between
/// them the steps average out.
double of_steps(std::span<const double> velocity_deg_s, Hertz rate) {
    double sum = 0.0;
    std::size_t begin = 0;
    for (std::size_t k = 1; k < velocity_deg_s.size(); ++k) {
        if (velocity_deg_s[k] == velocity_deg_s[begin]) continue;
        if (begin > 0 && k - begin >= fewest_alike) {
            const double before = velocity_deg_s[begin - 1] - velocity_deg_s[begin],
                         after = velocity_deg_s[k] - velocity_deg_s[begin];
            const double seconds = static_cast<double>(k - begin) / rate.value();
            if (std::abs(before - after) <= same_step * std::abs(after))
                sum += square_off * after * after * seconds * seconds;
        }
        begin = k;
    }
    return sum / (static_cast<double>(velocity_deg_s.size()) / rate.value());
}

/// Variance that the velocity's noise adds to its sum in each second, in deg^2/s: the noise of means over 25
/// ms, which motion hardly bends, times their length; plus the error of a velocity in coarse steps where it
/// turns. 0 for a log of fewer than a hundred means.
double summed_noise(const TraceView& log) {
    // Chosen, not derived: long enough for the noise that a filter passes, short enough for motion of some
    // hertz.
    constexpr double mean_over_s = 0.025;
    constexpr std::size_t fewest_means = 100;  // chosen, not derived: their median is within a tenth
    const auto samples =
        static_cast<std::size_t>(std::max(1.0, std::round(mean_over_s * log.sample_rate.value())));
    std::vector<double> means;
    for (std::size_t first = 0; first + samples <= log.size(); first += samples) {
        double sum = 0.0;
        for (std::size_t k = first; k < first + samples; ++k) sum += log.velocity_deg_s[k];
        means.push_back(sum / static_cast<double>(samples));
    }
    if (means.size() < fewest_means) return 0.0;
    const double deviation = noise_from_differences(means, 3);
    return deviation * deviation * static_cast<double>(samples) / log.sample_rate.value() +
           of_steps(log.velocity_deg_s, log.sample_rate);
}

constexpr std::size_t most_orders = 4;  // chosen, not derived: the clearest carry nearly all information
// Chosen, not derived: share of the fastest speed, as of a poor tachometer.
constexpr double offset_share = 0.01;
constexpr int most_climbing_steps = 40;  // chosen, not derived; four to eight are usual

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
VectorXd best_of_starts(const RipplePower& power, DegPerSec likely_offset) {
    VectorXd best = climbed(power, VectorXd::Zero(power.unknowns()));
    double most = power.at(best).value;
    for (const double deviations : {-1.0, 1.0}) {
        VectorXd start = VectorXd::Zero(power.unknowns());
        start[power.offset()] = deviations * likely_offset.value();
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

DegPerSec velocity_noise(const TraceView& log) {
    constexpr double apart_s = 0.01;       // chosen, not derived: sine motion of 2 Hz adds 0.05 % of itself
    constexpr double moving_share = 0.05;  // of the fastest speed: at rest an encoder has no noise
    constexpr std::size_t fewest_rows = 100;  // chosen, not derived: their median is within a tenth
    const auto apart = static_cast<std::size_t>(std::max(1.0, std::round(apart_s * log.sample_rate.value())));
    const double slow_deg_s = moving_share * fastest_of(log.velocity_deg_s);
    std::size_t run = 0, rows = 0;  // first row of the run; rows that count
    const double noise = noise_from_differences(log.velocity_deg_s, 3, apart, [&](std::size_t k) {
        for (std::size_t at = run + 1; at <= k; ++at)
            if (log.starts_run(at)) run = at;
        const bool is = k >= run + 3 * apart && std::abs(log.velocity_deg_s[k]) >= slow_deg_s;
        rows += is ? 1 : 0;
        return is;
    });
    return DegPerSec(rows < fewest_rows ? 0.0 : noise);
}

std::optional<VelocityFit> fit_velocity_error(std::span<const TraceView> logs, std::span<const Sweep> sweeps,
                                              std::span<const std::vector<double>> noise,
                                              std::span<const double> orders) {
    orders = orders.first(std::min(orders.size(), most_orders));
    double fastest = 0.0;
    std::vector<double> noise_of_log;
    for (const TraceView& log : logs) noise_of_log.push_back(log.has_position() ? 0.0 : summed_noise(log));
    std::vector<DemodulatedSweep> all;
    for (std::size_t i = 0; i < sweeps.size(); ++i) {
        const Sweep& sweep = sweeps[i];
        fastest = std::max(fastest, sweep.fast_deg_s);
        for (std::size_t n = 0; n < orders.size(); ++n) {
            if (!(noise[n][i] > 0.0)) continue;
            all.push_back(demodulated(logs[sweep.log], sweep, orders[n]));
            all.back().sweep = i;
            all.back().order = n;
            all.back().noise = noise[n][i];
            all.back().variance_per_s = noise_of_log[sweep.log] / (360.0 * 360.0);
        }
    }
    if (all.empty()) return std::nullopt;
    const DegPerSec likely_offset(offset_share * fastest);
    const RipplePower power(std::move(all), orders.size(), likely_offset);
    const VectorXd best = best_of_starts(power, likely_offset);
    const MatrixXd stiffness = power.at(best).expected;
    const SymmetricFactors factors(stiffness);
    if (!(factors.least_pivot() > 0.0)) return std::nullopt;
    const RipplePower::SlopeVariance slopes = power.slope_variance(best);
    const auto between = [&](const MatrixXd& variance) {
        return factors.solve(MatrixXd(factors.solve(variance).transpose()));
    };
    const MatrixXd own = between(slopes.own), common = between(slopes.common), covariance = own + common;
    VelocityFit fit;
    fit.error = {DegPerSec(best[power.offset()]), DegPerSec(deviation(covariance, power.offset()))};
    fit.order_shares.assign(best.begin(), best.begin() + static_cast<Eigen::Index>(orders.size()));
    fit.most_cycles = power.most_cycles(best);
    // The variance of the clearest order beyond what noise of the torque would leave if the other unknowns
    // were known.
    const double alone = slopes.own(0, 0) / (stiffness(0, 0) * stiffness(0, 0));
    fit.order_share_error = std::sqrt(common(0, 0) + std::max(0.0, own(0, 0) - alone));
    return fit;
}

}  // namespace ripplenotch
