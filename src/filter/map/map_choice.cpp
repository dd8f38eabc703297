// SPDX-License-Identifier: MIT
#include "filter/map/map_choice.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <span>

#include "filter/map/map_regression.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/phasor.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

using Eigen::ArrayXd, Eigen::MatrixXcd, Eigen::MatrixXd;

// The probability that a map has an order although no order is there, and that it has another order beside
// one.
constexpr double map_false_alarm = 0.01, other_order_false_alarm = 0.05;
// Speeds of a map that depends on it. Cross-validation on six joints of a robot: 4, 6 and 8 are alike.
constexpr std::size_t most_speeds = 5;
constexpr double least_warming_degc = 1.0;        ///< a narrower range does not determine what a degree does
constexpr std::size_t surrogates_an_order = 200;  ///< twice what the smallest level of the test resolves
// Orders that are compared with: so far to both sides, beyond what the joint's turn modulates. Of ten that
// are independent, noise at the order is twice the largest once in 66 logs (exponential variables).
constexpr double nearest_order = 0.1, order_span = 0.3, farthest_start = 0.3;
constexpr int compared_orders = 15;
constexpr double above_neighbours = 2.0;
constexpr std::size_t injections = 20;
constexpr double injection_step = 1.25;
constexpr double most_injected = 10.0;  ///< times the rms amplitude: a test that misses this has no power
// By which a map has to be better than none. Without, one of 134 readings of real logs at a gear ratio that
// is not theirs, or without ripple, had a map.
constexpr double least_errors_better = 2.0;
// Squares of an order that is there for certain. The noise of order 1 is measured at 1.5 alone, where a
// spectrum that falls with the third power of the frequency is 11 times smaller.
constexpr double certain_over_noise = 4.0, certain_over_noise_above = 11.0, one_sided_below = 1.1;

// Columns that say nothing are shrunk, so that a few forms are enough: each of speed, direction, second comb
// and temperature is in or not. The one with the fewest columns first.
std::vector<MapForm> candidate_forms(const MapData& data, bool tied) {
    const MapRange &speeds = data.frame.speeds_deg_s, &degc = data.frame.temperatures_degc;
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
                for (const bool warms : {false, true}) {
                    if ((comb != 0 && !tied) || (warms && !(degc.to - degc.from > least_warming_degc)))
                        continue;
                    forms.push_back({at, directions, 0, false, warms, comb});
                }
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

// Squares, in variances of each part of the noise, by which one amplitude of noise reduces them at most.
double least_reduction(double level) { return -2.0 * portable::log(level); }

// The mean over its standard error.
double in_errors(const ArrayXd& by_block) {
    const double blocks = static_cast<double>(by_block.size()), mean = by_block.mean();
    const double square = (by_block - mean).square().sum() / std::max(blocks * (blocks - 1.0), 1.0);
    return square > 0.0 ? mean / std::sqrt(square) : 0.0;
}

// Leakage of a torque that repeats with the joint's position has the same phase in all sweeps, and so at
// every order nearby. A line of the motor has not: the same amplitudes turned by another order's angle
// cancel.
bool stands_above_neighbours(const MapData& data, const MapForm& form, std::size_t order) {
    const auto reduction = [&](const MapData& of) {
        return MapRegression(of, form, order).reduction().sum().real();
    };
    const double ratio = data.frame.gear_ratio.value(), own = reduction(data);
    const double start = std::min(nearest_order + data.frame.orders[order].value() / ratio, farthest_start);
    for (int k = 0; k < 2 * compared_orders; ++k) {
        const double aside = (k % 2 == 0 ? 1.0 : -1.0) * (start + order_span * (k / 2) / compared_orders);
        MapData turned = data;
        for (MapWindow& window : turned.windows) {
            const double cycles = aside * ratio * window.state.position_deg / 360.0;
            window.value[order] *= portable::phasor(2.0 * std::numbers::pi * (cycles - std::floor(cycles)));
        }
        if (own < above_neighbours * reduction(turned)) return false;
    }
    return true;
}

/// Rotation test of one order. What is not locked to the motor has in each block of a log a phase of its own:
/// logs whose blocks are turned at random are draws of the null hypothesis, whatever its noise is. Beyond any
/// of them counts even with four blocks, since four random phases are hardly alike. The statistic is the
/// reduction of left-out squares, in deviations of its draws, largest of all forms.
struct RotationTest {
    std::vector<MapForm> forms;
    double level;       ///< false-alarm probability at which an order alone makes a map
    MatrixXcd phasors;  ///< the first draw is the log itself

    RotationTest(const MapData& data, bool tied)
        : forms(candidate_forms(data, tied)),
          level(map_false_alarm / static_cast<double>(data.frame.orders.size())),
          phasors(random_phasors(data.blocks, surrogates_an_order * data.frame.orders.size(), 20)) {
        phasors.col(0).setOnes();
    }
    /// The false-alarm probability: the share of draws that are as large, the log itself counted. 1 where the
    /// noise beside the order alone may be as large (chi-square of two degrees of freedom at `level`), or
    /// where the order is no line among its neighbours.
    [[nodiscard]] double false_alarm(const MapData& data, std::size_t order,
                                     std::span<const MapForm> of_forms) const {
        ArrayXd largest = ArrayXd::Constant(phasors.cols(), -std::numeric_limits<double>::infinity());
        double most = 0.0;
        const MapForm* best = &of_forms.front();
        for (const MapForm& form : of_forms) {
            const MatrixXcd reduction = MapRegression(data, form, order).reduction();
            const MatrixXcd turned = phasors.conjugate().cwiseProduct(reduction * phasors);
            const ArrayXd squares = turned.colwise().sum().real().transpose().array();
            const ArrayXd beyond = squares - squares.mean();
            const double spread = std::sqrt(beyond.square().mean());
            most = std::max(most, squares(0));
            if (!(spread > 0.0)) continue;
            if (beyond(0) / spread > largest(0)) best = &form;
            largest = largest.max(beyond / spread);
        }
        if (!(most > least_reduction(level))) return 1.0;
        const double share =
            static_cast<double>((largest >= largest(0)).count()) / static_cast<double>(largest.size());
        const bool none = share > other_order_false_alarm;
        return none || stands_above_neighbours(data, *best, order) ? share : 1.0;
    }
};

// The amplitude of an order, Nm, that is found in 20 of 20 logs like this one that hold it: alike at every
// speed, at a random phase, beside the log's own amplitudes with the phases of its blocks drawn at random.
// Infinity where there is none.
double detectable_amplitude(const MapData& data, const MapRegression& own, const RotationTest& test,
                            std::size_t order) {
    const MatrixXcd phasors = random_phasors(data.blocks + 1, injections, 21);
    const auto found = [&](double amplitude_nm, Eigen::Index trial) {
        MapData injected = data;
        for (MapWindow& window : injected.windows) {
            window.value[order] *= phasors(static_cast<Eigen::Index>(window.block), trial);
            window.value[order] += amplitude_nm * phasors(phasors.rows() - 1, trial);
        }
        const MapRegression alike(injected, test.forms.front(), order);
        ArrayXd better = -alike.residuals().diagonal().array();
        for (std::size_t b = 0; b < data.blocks; ++b)
            better(static_cast<Eigen::Index>(b)) += alike.squares(b).total;
        return in_errors(better) > least_errors_better &&
               test.false_alarm(injected, order, test.forms) <= test.level;
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
// differ by their ripple, would be too much. `left_out` has no say; the number of blocks for none.
std::size_t smallest_good(const std::vector<MatrixXd>& residuals, Eigen::Index left_out) {
    std::vector<double> sums;
    for (const MatrixXd& one : residuals) {
        sums.push_back(left_out < one.rows() ? one.row(left_out).sum() - one(left_out, left_out)
                                             : one.trace());
    }
    const double enough = *std::min_element(sums.begin(), sums.end()) + least_reduction(map_false_alarm);
    const auto good = std::find_if(sums.begin(), sums.end(), [&](double sum) { return sum <= enough; });
    return static_cast<std::size_t>(good - sums.begin());
}

}  // namespace

void choose_map(const MapData& data, MapFit& fit) {
    const RotationTest test(data, fit.anchored);
    const auto blocks = static_cast<Eigen::Index>(data.blocks);
    const std::size_t orders = data.frame.orders.size();
    std::vector<bool> chooses;
    for (std::size_t i = 0; i < orders; ++i) {
        fit.scores.push_back({data.frame.orders[i].value()});
        fit.scores[i].false_alarm = test.false_alarm(data, i, test.forms);
        chooses.push_back(fit.scores[i].false_alarm <= test.level);
    }
    // Residual squares of left-out blocks: of each form by order, and of each form over the orders that
    // choose.
    std::vector<std::vector<MatrixXd>> residuals(orders);
    std::vector<MatrixXd> sums;
    const bool any = std::find(chooses.begin(), chooses.end(), true) != chooses.end();
    for (const MapForm& form : std::span(test.forms).first(any ? test.forms.size() : 1)) {
        sums.emplace_back(MatrixXd::Zero(blocks, blocks));
        for (std::size_t i = 0; i < orders; ++i) {
            residuals[i].push_back(MapRegression(data, form, i).residuals());
            if (chooses[i]) sums.back() += residuals[i].back();
        }
    }
    const std::size_t chosen = smallest_good(sums, blocks);
    fit.map.form = test.forms[chosen];
    std::vector<double> errors_better;
    bool mapped = false;
    for (std::size_t i = 0; i < orders; ++i) {
        MapOrderScore& score = fit.scores[i];
        // The form was chosen without the other orders: they are tested under that form alone.
        if (any && !chooses[i])
            score.false_alarm = test.false_alarm(data, i, std::span(test.forms).subspan(chosen, 1));
        const MapRegression alike(data, test.forms.front(), i);
        MapSquares all;
        double residual = 0.0;
        ArrayXd better(blocks);
        for (Eigen::Index b = 0; b < blocks; ++b) {
            const MapSquares squares = alike.squares(static_cast<std::size_t>(b));
            all.total += squares.total;
            all.noise += squares.noise;
            all.weights += squares.weights;
            const double left = residuals[i][smallest_good(sums, b)](b, b);
            residual += left;
            better(b) = squares.total - left;
        }
        if (all.weights > 0.0) {
            score.ripple_nm = std::sqrt(all.total / all.weights);
            score.noise_nm = std::sqrt(all.noise / all.weights);
            score.left_nm = std::sqrt(residual / all.weights);
        }
        if (all.total > all.noise)
            score.predicted_share = std::clamp((all.total - residual) / (all.total - all.noise), 0.0, 1.0);
        errors_better.push_back(in_errors(better));
        mapped = mapped || (chooses[i] && errors_better[i] > least_errors_better);
        fit.notes.push_back(fmt::format(
            "order {}: false-alarm probability {:.2g}; of {:.4g} squares of left-out blocks the simplest "
            "form "
            "leaves {:.4g}, the one taken {:.4g}, and {:.4g} where it is chosen without the block",
            shortest(score.order), score.false_alarm, all.total, residuals[i].front().trace(),
            residuals[i][chosen].trace(), residual));
    }
    bool unclear = false;
    for (std::size_t i = 0; i < orders; ++i) {
        MapOrderScore& score = fit.scores[i];
        score.in_map = mapped && errors_better[i] > 0.0 && score.false_alarm <= other_order_false_alarm;
        if (score.in_map) continue;
        const MapRegression alike(data, test.forms.front(), i);
        score.detectable_nm = detectable_amplitude(data, alike, test, i);
        // What the log itself has and the test did not find bounds nothing.
        if (std::norm(alike.values()(0)) > score.detectable_nm * score.detectable_nm)
            score.detectable_nm = std::numeric_limits<double>::infinity();
        // Amplitudes beyond the noise that follow no form tried may be a ripple of another form.
        const double over = score.order < one_sided_below ? certain_over_noise_above : certain_over_noise;
        const bool certain = score.ripple_nm * score.ripple_nm >= over * score.noise_nm * score.noise_nm;
        unclear = unclear || certain || !std::isfinite(score.detectable_nm);
    }
    fit.finding = mapped ? MapFinding::mapped : unclear ? MapFinding::unclear : MapFinding::nothing;
}

}  // namespace ripplenotch
