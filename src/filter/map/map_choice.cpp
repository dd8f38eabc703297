// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <random>
#include <span>
#include <vector>

#include "core/process/two_cores.hpp"
#include "filter/map/map_regression.hpp"
#include "ripplenotch/core/gear_account.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/portable_math.hpp"
#include "ripplenotch/filter/map_fit.hpp"

namespace ripplenotch {

namespace {

// Which orders are ripple, and the form of their map: by blocks of windows that are left out of the fit.

using Eigen::ArrayXd, Eigen::MatrixXcd, Eigen::MatrixXd, Eigen::VectorXcd;

// Probability that a map has an order that is not there in addition to those that are.
constexpr double other_order_false_alarm = 0.05;
// That noise alone makes a form look better than a smaller one.
constexpr double form_false_alarm = 0.01;
// Speeds of a map that depends on it. Cross-validation on six joints of a robot: 4, 6 and 8 are alike.
constexpr std::size_t most_speeds = 5;
constexpr double random_draws = 1000.0;
constexpr Eigen::Index draws_in_tail = 50;  ///< which give its scale to 14 %
// Orders that are compared with: so far to both sides, beyond the modulation by the joint's turn. Of ten that
// are independent, noise at the order is twice the largest once in 66 logs (exponential variables).
constexpr double nearest_order = 0.1, order_span = 0.3, farthest_start = 0.3;
constexpr int compared_orders = 15;
constexpr double above_neighbours = 2.0;
constexpr std::size_t injections = 20;
constexpr double injection_step = 1.25;
constexpr double most_injected = 10.0;  ///< times the rms amplitude: a test that misses this has no power
// Squares of an order that is there for certain. The noise of order 1 is measured at 1.5 alone, where a
// spectrum that falls with the third power of the frequency is 11 times smaller.
constexpr double certain_over_noise = 4.0, certain_over_noise_above = 11.0, one_sided_below = 1.1;

// Columns without information are shrunk, so that a few forms are enough: each of speed, direction and
// second comb is in or not. The one with the fewest columns first.
std::vector<MapForm> candidate_forms(const MapData& data, bool tied) {
    const MapRange& speeds = data.frame.speeds_deg_s;
    std::vector<std::vector<double>> knots = {{speeds.middle()}};
    if (speeds.to > speeds.from) {
        knots.emplace_back();
        for (std::size_t k = 0; k < most_speeds; ++k) {
            const double share = static_cast<double>(k) / static_cast<double>(most_speeds - 1);
            knots.back().push_back(speeds.from + (speeds.to - speeds.from) * share);
        }
    }
    std::vector<MapForm> forms;
    for (const std::vector<double>& at : knots) {
        for (const std::size_t directions : {1U, 2U}) {
            for (const int comb : {0, 1, -1}) {
                if (comb == 0 || (tied && data.frame.gear_ratio != no_ratio))
                    forms.push_back({at, directions, comb});
            }
        }
    }
    std::stable_sort(forms.begin(), forms.end(),
                     [](const MapForm& a, const MapForm& b) { return a.columns() < b.columns(); });
    return forms;
}

/// The random numbers of all tests: unit phasors, by block and draw.
MatrixXcd random_phasors(std::size_t blocks, std::size_t draws, unsigned seed) {
    std::mt19937_64 engine(seed);
    MatrixXcd phasors(static_cast<Eigen::Index>(blocks), static_cast<Eigen::Index>(draws));
    for (auto& phasor : phasors.reshaped()) {
        const double share = static_cast<double>(engine() >> 11U) * 0x1p-53;
        phasor = portable::phasor(2.0 * std::numbers::pi * share);
    }
    return phasors;
}

/// The same for each order, unlike those of the others; the first draw is the log itself.
class RandomPhases {
  public:
    RandomPhases(std::size_t blocks, double draws, std::size_t orders)
        : blocks_(static_cast<Eigen::Index>(blocks)),
          all_(random_phasors(blocks * orders, static_cast<std::size_t>(draws) + 1, 20)) {
        all_.col(0).setOnes();
    }
    [[nodiscard]] Eigen::Index count() const { return all_.cols(); }
    [[nodiscard]] MatrixXcd of(std::size_t order) const {
        return all_.middleRows(static_cast<Eigen::Index>(order) * blocks_, blocks_);
    }

  private:
    Eigen::Index blocks_;
    MatrixXcd all_;
};

// Squares, in variances of each part of the noise, by which one amplitude of noise reduces them at most.
double least_reduction(double level) { return -2.0 * portable::log(level); }

// Leakage of a torque that repeats with the joint's position has the same phase in all sweeps, and so at
// every order nearby. A line of the motor has not: the same amplitudes turned by another order's angle
// cancel.
bool stands_above_neighbours(const MapData& data, const MapForm& form, std::size_t order,
                             const VectorXcd& amplitudes) {
    const double ratio = data.counted.gear_ratio;
    const double start = std::min(nearest_order + data.counted.orders[order] / ratio, farthest_start);
    MatrixXcd turned = amplitudes.replicate(1, 1 + 2 * compared_orders);  // the first as it is
    for (Eigen::Index w = 0; w < turned.rows(); ++w) {
        const double turns = ratio * data.windows[static_cast<std::size_t>(w)].state.position_deg / 360.0;
        for (int k = 0; k < 2 * compared_orders; ++k) {
            const double aside = (k % 2 == 0 ? 1.0 : -1.0) * (start + order_span * (k / 2) / compared_orders);
            const double cycles = aside * turns;
            turned(w, k + 1) *= portable::phasor(2.0 * std::numbers::pi * (cycles - std::floor(cycles)));
        }
    }
    const Eigen::VectorXd found = MapRegression(data, form, order, amplitudes).reductions(turned);
    return found(0) >= above_neighbours * found.tail(2 * compared_orders).maxCoeff();
}

/// Rotation test. Torque that is not locked to the motor has in each block of a log, and at each order, a
/// phase of its own: logs whose blocks are turned at random are draws of the null hypothesis, whatever its
/// noise is. A statistic above all draws is significant even with four blocks, since four random phases are
/// hardly alike. Of an order it is the reduction of left-out squares, in deviations of its draws, largest of
/// all forms; of the motor the largest of its orders or their sum, so that several weak orders count
/// together.
class RotationTest {
  public:
    RotationTest(const MapData& data, bool tied, double level)
        : forms_(candidate_forms(data, tied)),
          level_(level),
          draws_(data.blocks, random_draws, data.frame.orders.size()) {
        const std::size_t orders = data.frame.orders.size();
        reductions_.resize(orders);
        largest_.resize(orders);
        on_two_cores(orders, [&](std::size_t order) {
            for (const MapForm& form : forms_)
                reductions_[order].emplace_back(MapRegression(data, form, order));
            largest_[order] = largest(order, reductions_[order]);
        });
    }
    [[nodiscard]] const std::vector<MapForm>& forms() const { return forms_; }
    [[nodiscard]] double level() const { return level_; }

    /// The probability that an order is as large by chance.
    [[nodiscard]] double false_alarm(std::size_t order) const { return share(largest_[order]); }
    /// The same under one form alone.
    [[nodiscard]] double false_alarm(std::size_t order, std::size_t form) const {
        return share(largest(order, std::span(reductions_[order]).subspan(form, 1)));
    }
    [[nodiscard]] double motor_false_alarm(const std::vector<bool>& orders) const {
        const ArrayXd all = of_motor(orders);
        return all.size() > 0 ? share(all) : 1.0;
    }
    /// The deviations of one order alone at which the motor is significant at the level.
    [[nodiscard]] double threshold(std::size_t order) const {
        const ArrayXd all = of_motor(std::vector<bool>(reductions_.size(), true));
        const Standard one(largest_[order]);
        return all.size() > 0 ? one.mean + Tail(all).exceeded_by(level_) * one.spread
                              : std::numeric_limits<double>::infinity();
    }
    /// The most squares that a form reduces of an order, and which form has the most deviations.
    [[nodiscard]] double squares(std::size_t order) const {
        double most = 0.0;
        for (const Reduction& one : reductions_[order]) most = std::max(most, one.squares);
        return most;
    }
    [[nodiscard]] const MapForm& best_form(std::size_t order) const {
        const auto& all = reductions_[order];
        const auto best = std::max_element(
            all.begin(), all.end(),
            [](const Reduction& a, const Reduction& b) { return a.deviations() < b.deviations(); });
        return forms_[static_cast<std::size_t>(best - all.begin())];
    }

    /// What a form reduces of left-out squares, as a function of the phases of the blocks.
    struct Reduction {
        MatrixXcd form;
        double squares, mean, spread;  ///< of the log itself; of random phases

        explicit Reduction(const MapRegression& of)
            : form(of.reduction()),
              squares(form.sum().real()),
              mean(form.trace().real()),
              // Of a Hermitian form of independent unit phasors the terms off the diagonal vary.
              spread(std::sqrt(std::max(form.cwiseAbs2().sum() - form.diagonal().cwiseAbs2().sum(), 0.0))) {}
        [[nodiscard]] double deviations() const { return spread > 0.0 ? (squares - mean) / spread : 0.0; }
    };

  private:
    struct Standard {
        double mean, spread;
        explicit Standard(const ArrayXd& draws)
            : mean(draws.mean()), spread(std::sqrt((draws - draws.mean()).square().mean())) {}
    };
    /// The largest draws, beyond which the probability falls exponentially (Knijnenburg et al. 2009): a
    /// Hermitian form of one column has an exponential tail, and those of several fall faster.
    struct Tail {
        ArrayXd draws;  ///< falling, without the log itself
        double from, scale;

        explicit Tail(const ArrayXd& all) : draws(all.tail(all.size() - 1)) {
            std::sort(draws.begin(), draws.end(), std::greater<>());
            from = draws(draws_in_tail);
            scale = (draws.head(draws_in_tail) - from).mean();
        }
        [[nodiscard]] double share() const {
            return static_cast<double>(draws_in_tail) / static_cast<double>(draws.size());
        }
        [[nodiscard]] double exceeded_by(double probability) const {
            return from + scale * portable::log(share() / probability);
        }
        [[nodiscard]] double probability(double value) const {
            if (value > from && scale > 0.0) return share() * portable::exp(-(value - from) / scale);
            return static_cast<double>((draws >= value).count() + 1) / static_cast<double>(draws.size() + 1);
        }
    };
    static double share(const ArrayXd& of_draws) { return Tail(of_draws).probability(of_draws(0)); }
    [[nodiscard]] ArrayXd largest(std::size_t order, std::span<const Reduction> of) const {
        ArrayXd found = ArrayXd::Constant(draws_.count(), 0.0);
        const MatrixXcd phasors = draws_.of(order);
        for (const Reduction& one : of) {
            if (!(one.spread > 0.0)) continue;
            const MatrixXcd turned = phasors.conjugate().cwiseProduct(one.form * phasors);
            found = found.max((turned.colwise().sum().real().transpose().array() - one.mean) / one.spread);
        }
        return found;
    }
    // Each order in deviations of its own draws, so that none weighs more.
    [[nodiscard]] ArrayXd of_motor(const std::vector<bool>& orders) const {
        ArrayXd most, sum;
        double count = 0.0;
        for (std::size_t i = 0; i < orders.size(); ++i) {
            const Standard standard(largest_[i]);
            if (!orders[i] || !(standard.spread > 0.0)) continue;
            const ArrayXd one = (largest_[i] - standard.mean) / standard.spread;
            most = count > 0.0 ? ArrayXd(most.max(one)) : one;
            sum = count > 0.0 ? ArrayXd(sum + one) : one;
            count += 1.0;
        }
        return count > 0.0 ? ArrayXd(most.max(sum / std::sqrt(count))) : ArrayXd();
    }

    std::vector<MapForm> forms_;
    double level_;
    RandomPhases draws_;
    std::vector<std::vector<Reduction>> reductions_;  ///< by order, by form
    std::vector<ArrayXd> largest_;                    ///< by order: of all forms, by draw
};

// The amplitude of an order, Nm, that is found in 20 of 20 logs like this one that hold it: alike at every
// speed, at a random phase, added to the log's own amplitudes with the phases of its blocks drawn at random.
// It counts as found where the simplest form alone is significant: the other forms can only add to it.
// Infinity where there is none.
double detectable_amplitude(const MapData& data, const MapRegression& own, const RotationTest& test,
                            std::size_t order) {
    const MatrixXcd phasors = random_phasors(data.blocks + 1, injections, 21);
    const double threshold = test.threshold(order);
    const MapForm& simplest = test.forms().front();
    const auto found = [&](double amplitude_nm, Eigen::Index trial) {
        VectorXcd injected = amplitudes_of(data, order);
        for (Eigen::Index w = 0; w < injected.size(); ++w) {
            const auto block = static_cast<Eigen::Index>(data.windows[static_cast<std::size_t>(w)].block);
            injected(w) *= phasors(block, trial);
            injected(w) += amplitude_nm * phasors(phasors.rows() - 1, trial);
        }
        const RotationTest::Reduction reduction(MapRegression(data, simplest, order, injected));
        if (!(reduction.deviations() > threshold) || !(reduction.squares > least_reduction(test.level())))
            return false;
        return stands_above_neighbours(data, simplest, order, injected);
    };
    double amplitude_nm = std::sqrt(own.noise() / static_cast<double>(data.windows.size()));
    for (; amplitude_nm < most_injected * std::sqrt(own.energy()); amplitude_nm *= injection_step) {
        Eigen::Index seen = 0;
        while (seen < phasors.cols() && found(amplitude_nm, seen)) ++seen;
        if (seen == phasors.cols()) return amplitude_nm;
    }
    return std::numeric_limits<double>::infinity();
}

// The first form whose squares are those of the best but for what noise alone reduces them by: a form that
// shrinks where the log determines little costs little, so that a standard error over a few blocks, which
// differ by their ripple, would be too much. Block `left_out` does not count; the number of blocks for none.
std::size_t smallest_good(const std::vector<MatrixXd>& residuals, Eigen::Index left_out) {
    std::vector<double> sums;
    for (const MatrixXd& one : residuals) {
        sums.push_back(left_out < one.rows() ? one.row(left_out).sum() - one(left_out, left_out)
                                             : one.trace());
    }
    const double enough = *std::min_element(sums.begin(), sums.end()) + least_reduction(form_false_alarm);
    const auto good = std::find_if(sums.begin(), sums.end(), [&](double sum) { return sum <= enough; });
    return static_cast<std::size_t>(good - sums.begin());
}

}  // namespace

void choose_map(const MapData& data, double level, MapFit& fit) {
    const RotationTest test(data, fit.anchored, level);
    const auto blocks = static_cast<Eigen::Index>(data.blocks);
    const std::size_t orders = data.frame.orders.size();
    std::vector<bool> is_line(orders, true), may_be, chooses;
    for (std::size_t i = 0; i < orders; ++i) {
        MapOrderScore& score = fit.scores.emplace_back();
        score.order = data.frame.orders[i].value();
        score.false_alarm = test.false_alarm(i);
        is_line[i] = score.false_alarm > other_order_false_alarm ||
                     stands_above_neighbours(data, test.best_form(i), i, amplitudes_of(data, i));
    }
    fit.false_alarm = test.motor_false_alarm(is_line);
    for (std::size_t i = 0; i < orders; ++i) {
        // Neither noise as it is near the order, nor leakage of a slow torque.
        may_be.push_back(is_line[i] && test.squares(i) > least_reduction(level));
        if (!may_be[i]) fit.scores[i].false_alarm = 1.0;
        chooses.push_back(fit.false_alarm <= level && fit.scores[i].false_alarm <= other_order_false_alarm);
    }
    // Residual squares of left-out blocks: of each form by order, and of each form over the orders that
    // choose.
    std::vector<std::vector<MatrixXd>> residuals(orders);
    std::vector<MatrixXd> sums;
    const bool any = std::find(chooses.begin(), chooses.end(), true) != chooses.end();
    for (const MapForm& form : std::span(test.forms()).first(any ? test.forms().size() : 1)) {
        sums.emplace_back(MatrixXd::Zero(blocks, blocks));
        for (std::size_t i = 0; i < orders; ++i) {
            residuals[i].push_back(MapRegression(data, form, i).residuals());
            if (chooses[i]) sums.back() += residuals[i].back();
        }
    }
    const std::size_t chosen = smallest_good(sums, blocks);
    fit.map.form = test.forms()[chosen];
    std::vector<double> better;  ///< squares of left-out blocks that the map reduces, by order
    for (std::size_t i = 0; i < orders; ++i) {
        MapOrderScore& score = fit.scores[i];
        // The form was chosen without the other orders: they are tested under that form alone.
        if (any && !chooses[i]) score.false_alarm = may_be[i] ? test.false_alarm(i, chosen) : 1.0;
        const MapRegression alike(data, test.forms().front(), i);
        MapSquares all;
        double residual = 0.0;
        for (Eigen::Index b = 0; b < blocks; ++b) {
            const MapSquares squares = alike.squares(static_cast<std::size_t>(b));
            all.total += squares.total;
            all.noise += squares.noise;
            all.weights += squares.weights;
            residual += residuals[i][smallest_good(sums, b)](b, b);
        }
        if (all.weights > 0.0) {
            score.ripple_nm = std::sqrt(all.total / all.weights);
            score.noise_nm = std::sqrt(all.noise / all.weights);
            score.left_nm = std::sqrt(residual / all.weights);
        }
        if (all.total > all.noise)
            score.predicted_share = std::clamp((all.total - residual) / (all.total - all.noise), 0.0, 1.0);
        better.push_back(all.total - residual);
        fit.notes.push_back(fmt::format(
            "order {}: false-alarm probability {:.2g}; of {:.4g} squares of left-out blocks the simplest "
            "form "
            "leaves {:.4g}, the one taken {:.4g}, and {:.4g} where it is chosen without the block",
            shortest(score.order), score.false_alarm, all.total, residuals[i].front().trace(),
            residuals[i][chosen].trace(), residual));
    }
    double all_better = 0.0;
    for (std::size_t i = 0; i < orders; ++i) all_better += chooses[i] ? better[i] : 0.0;
    const bool mapped = all_better > 0.0;
    bool unclear = false;
    for (std::size_t i = 0; i < orders; ++i) {
        MapOrderScore& score = fit.scores[i];
        score.in_map = mapped && better[i] > 0.0 && score.false_alarm <= other_order_false_alarm;
        if (score.in_map) continue;
        const MapRegression alike(data, test.forms().front(), i);
        score.detectable_nm = detectable_amplitude(data, alike, test, i);
        // A ripple in the log itself that the test did not find gives no bound.
        if (std::norm(alike.values()(0)) > score.detectable_nm * score.detectable_nm)
            score.detectable_nm = std::numeric_limits<double>::infinity();
        // Amplitudes beyond the noise that follow no form tried may be a ripple of another form.
        const double over =
            data.counted.orders[i] < one_sided_below ? certain_over_noise_above : certain_over_noise;
        const bool certain = score.ripple_nm * score.ripple_nm >= over * score.noise_nm * score.noise_nm;
        unclear = unclear || certain || !std::isfinite(score.detectable_nm);
    }
    fit.finding = mapped ? MapFinding::mapped : unclear ? MapFinding::unclear : MapFinding::nothing;
}

}  // namespace ripplenotch
