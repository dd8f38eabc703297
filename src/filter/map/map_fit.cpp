// SPDX-License-Identifier: MIT
#include "filter/map/map_fit.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <random>
#include <span>

#include "filter/map/map_regression.hpp"
#include "filter/ripple/ripple_course.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/portable_math.hpp"
#include "ripplenotch/core/visible_text.hpp"
#include "ripplenotch/filter/map_fit.hpp"

namespace ripplenotch {

namespace {

constexpr std::size_t most_blocks = 16;  // chosen, not derived: parts that are left out in turn
constexpr std::size_t least_block = 3;   ///< windows, of which the middle one shares none of its samples

// Amplitudes and mean of what `torque_nm` holds along the log.
std::vector<RippleWindow> windows_of(const TraceView& log, const GearAccount& gear,
                                     std::span<const double> torque_nm) {
    std::vector<double> orders;
    for (const Order order : gear.orders) orders.push_back(order.value());
    MotorPath path(MotorAngle(gear.ratio.value(), log.sample_rate.value(), MotorAngle::Source::best, 0.0));
    RippleWindows windows(orders, log.sample_rate.value(), {});
    for (std::size_t k = 0; k < log.size(); ++k) {
        if (k > 0 && log.starts_run(k)) {
            windows.split();
            path.restart();
        }
        path.next(log.velocity_deg_s[k], log.has_position() ? &log.position_deg[k] : nullptr);
        windows.add(path, torque_nm[k]);
    }
    return windows.finish();
}

MapWindow window_of(const RippleWindow& window, const GearAccount& gear, double zero_deg, std::size_t log) {
    const double ratio = gear.ratio.value();
    MapWindow one;
    one.log = log;
    one.middle = window.middle;
    one.length = window.length;
    one.state = {360.0 * window.speed_turns_s / ratio, 360.0 * window.middle_turns / ratio, window.torque_nm};
    for (std::size_t i = 0; i < gear.orders.size(); ++i) {
        const double cycles = gear.orders[i].value() * ratio * zero_deg / 360.0;
        const double turned = 2.0 * std::numbers::pi * (cycles - std::floor(cycles));
        one.value.push_back(window.amplitudes[i] * std::conj(portable::phasor(turned)));
        one.noise.push_back(std::max(window.background[i], 2.0 * window.variance));
    }
    return one;
}

template <typename Value>
MapRange range_seen(const std::vector<MapWindow>& windows, const Value& value) {
    if (windows.empty()) return {};
    MapRange range{value(windows.front().state), value(windows.front().state)};
    for (const MapWindow& window : windows)
        range = {std::min(range.from, value(window.state)), std::max(range.to, value(window.state))};
    return range;
}

// Blocks of a log are alike in size. Windows half overlap: those at the ends of a block may share samples
// with the next one.
void number_blocks(MapData& data) {
    std::vector<MapWindow>& windows = data.windows;
    const std::size_t size = std::max(least_block, (windows.size() + most_blocks - 1) / most_blocks);
    for (std::size_t from = 0, to = 0; from < windows.size(); from = to) {
        while (to < windows.size() && windows[to].log == windows[from].log) ++to;
        const std::size_t count = to - from, blocks = (count + size - 1) / size;
        for (std::size_t i = from; i < to; ++i) windows[i].block = data.blocks + (i - from) * blocks / count;
        data.blocks += blocks;
    }
    for (std::size_t i = 1; i < windows.size(); ++i) {
        MapWindow &before = windows[i - 1], &after = windows[i];
        const double apart = after.middle - before.middle, share = 1e-9;
        const bool overlap = apart < (0.5 - share) * (before.length + after.length);
        if (after.log == before.log && after.block != before.block && overlap)
            before.scored = after.scored = false;
    }
}

}  // namespace

MapData map_data(std::span<const TraceView> logs, const GearAccount& gear, double zero_deg,
                 std::span<const std::vector<double>> temperatures_degc) {
    MapData data;
    for (std::size_t l = 0; l < logs.size(); ++l) {
        for (const RippleWindow& window : windows_of(logs[l], gear, logs[l].torque_nm))
            data.windows.push_back(window_of(window, gear, zero_deg, l));
        if (temperatures_degc.empty()) continue;
        const auto warmth = windows_of(logs[l], gear, temperatures_degc[l]);
        for (std::size_t i = 0, from = data.windows.size() - warmth.size(); i < warmth.size(); ++i)
            data.windows[from + i].state.temperature_degc = warmth[i].torque_nm;
    }
    data.frame.gear_ratio = gear.ratio;
    data.frame.orders = gear.orders;
    data.frame.zero_deg = zero_deg;
    data.frame.speeds_deg_s =
        range_seen(data.windows, [](const MapState& at) { return std::abs(at.speed_deg_s); });
    data.frame.positions_deg = range_seen(data.windows, [](const MapState& at) { return at.position_deg; });
    data.frame.loads_nm = range_seen(data.windows, [](const MapState& at) { return at.load_nm; });
    data.frame.temperatures_degc =
        range_seen(data.windows, [](const MapState& at) { return at.temperature_degc.value_or(0.0); });
    number_blocks(data);
    return data;
}

namespace {

// Which orders are ripple, and the form of their map: by blocks of windows that are left out of the fit.

using Eigen::ArrayXd, Eigen::MatrixXcd, Eigen::MatrixXd;

// False-alarm probabilities: that a map has an order although no order is present, and that it has another
// order in addition to a true one.
constexpr double map_false_alarm = 0.01, other_order_false_alarm = 0.05;
// Speeds of a map that depends on it. Cross-validation on six joints of a robot: 4, 6 and 8 are alike.
constexpr std::size_t most_speeds = 5;
constexpr double least_warming_degc = 1.0;  ///< a narrower range does not determine the effect of a degree
// Draws, and at least so many beyond the level, so that it is no matter of a single one.
constexpr double fewest_draws = 600.0, draws_beyond_level = 3.0;
// Orders that are compared with: so far to both sides, beyond the modulation by the joint's turn. Of ten that
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

// Columns without information are shrunk, so that a few forms are enough: each of speed, direction, second
// comb and temperature is in or not. The one with the fewest columns first.
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
          draws_(data.blocks, std::max(fewest_draws, draws_beyond_level / level), data.frame.orders.size()) {
        for (std::size_t order = 0; order < data.frame.orders.size(); ++order) {
            std::vector<Reduction>& of_order = reductions_.emplace_back();
            for (const MapForm& form : forms_) of_order.emplace_back(data, form, order);
            largest_.push_back(largest(order, of_order));
        }
    }
    [[nodiscard]] const std::vector<MapForm>& forms() const { return forms_; }
    [[nodiscard]] double level() const { return level_; }

    /// The share of draws in which an order is as large, the log itself counted.
    [[nodiscard]] double false_alarm(std::size_t order) const { return share(largest_[order]); }
    /// The same under one form alone.
    [[nodiscard]] double false_alarm(std::size_t order, std::size_t form) const {
        return share(largest(order, std::span(reductions_[order]).subspan(form, 1)));
    }
    [[nodiscard]] double motor_false_alarm(const std::vector<bool>& orders) const {
        const ArrayXd all = of_motor(orders);
        return all.size() > 0 ? share(all) : 1.0;
    }
    /// The deviations of one order alone that are too large for chance at the level of the motor.
    [[nodiscard]] double threshold(std::size_t order) const {
        ArrayXd drawn = largest_[order].tail(largest_[order].size() - 1);
        const auto beyond = static_cast<Eigen::Index>(level_ / static_cast<double>(orders()) *
                                                      static_cast<double>(drawn.size()));
        std::nth_element(drawn.begin(), drawn.begin() + beyond, drawn.end(), std::greater<>());
        return drawn(beyond);
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

        Reduction(const MapData& data, const MapForm& map_form, std::size_t order)
            : form(MapRegression(data, map_form, order).reduction()),
              squares(form.sum().real()),
              mean(form.trace().real()),
              // Of a Hermitian form of independent unit phasors the terms off the diagonal vary.
              spread(std::sqrt(std::max(form.cwiseAbs2().sum() - form.diagonal().cwiseAbs2().sum(), 0.0))) {}
        [[nodiscard]] double deviations() const { return spread > 0.0 ? (squares - mean) / spread : 0.0; }
    };

  private:
    [[nodiscard]] std::size_t orders() const { return reductions_.size(); }
    static double share(const ArrayXd& of_draws) {
        return static_cast<double>((of_draws >= of_draws(0)).count()) / static_cast<double>(of_draws.size());
    }
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
            if (!orders[i]) continue;
            const ArrayXd centred = largest_[i] - largest_[i].mean();
            const double spread = std::sqrt(centred.square().mean());
            if (!(spread > 0.0)) continue;
            most = count > 0.0 ? ArrayXd(most.max(centred / spread)) : ArrayXd(centred / spread);
            sum = count > 0.0 ? ArrayXd(sum + centred / spread) : ArrayXd(centred / spread);
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
        MapData injected = data;
        for (MapWindow& window : injected.windows) {
            window.value[order] *= phasors(static_cast<Eigen::Index>(window.block), trial);
            window.value[order] += amplitude_nm * phasors(phasors.rows() - 1, trial);
        }
        const RotationTest::Reduction reduction(injected, simplest, order);
        if (!(reduction.deviations() > threshold) || !(reduction.squares > least_reduction(test.level())))
            return false;
        const MapRegression alike(injected, simplest, order);
        ArrayXd better = -alike.residuals().diagonal().array();
        for (std::size_t b = 0; b < data.blocks; ++b)
            better(static_cast<Eigen::Index>(b)) += alike.squares(b).total;
        return in_errors(better) > least_errors_better && stands_above_neighbours(injected, simplest, order);
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
    const double enough = *std::min_element(sums.begin(), sums.end()) + least_reduction(map_false_alarm);
    const auto good = std::find_if(sums.begin(), sums.end(), [&](double sum) { return sum <= enough; });
    return static_cast<std::size_t>(good - sums.begin());
}

// Finding, scores, notes and the map's form, of data that have a window. Where `fit` is not anchored the
// joint's own angle is not known, and a second comb means nothing.
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
                     stands_above_neighbours(data, test.best_form(i), i);
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
    ArrayXd all_better = ArrayXd::Zero(blocks);
    std::vector<double> errors_better;
    for (std::size_t i = 0; i < orders; ++i) {
        MapOrderScore& score = fit.scores[i];
        // The form was chosen without the other orders: they are tested under that form alone.
        if (any && !chooses[i]) score.false_alarm = may_be[i] ? test.false_alarm(i, chosen) : 1.0;
        const MapRegression alike(data, test.forms().front(), i);
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
        if (chooses[i]) all_better += better;
        fit.notes.push_back(fmt::format(
            "order {}: false-alarm probability {:.2g}; of {:.4g} squares of left-out blocks the simplest "
            "form "
            "leaves {:.4g}, the one taken {:.4g}, and {:.4g} where it is chosen without the block",
            shortest(score.order), score.false_alarm, all.total, residuals[i].front().trace(),
            residuals[i][chosen].trace(), residual));
    }
    const bool mapped = any && in_errors(all_better) > least_errors_better;
    bool unclear = false;
    for (std::size_t i = 0; i < orders; ++i) {
        MapOrderScore& score = fit.scores[i];
        score.in_map = mapped && errors_better[i] > 0.0 && score.false_alarm <= other_order_false_alarm;
        if (score.in_map) continue;
        const MapRegression alike(data, test.forms().front(), i);
        score.detectable_nm = detectable_amplitude(data, alike, test, i);
        // A ripple in the log itself that the test did not find gives no bound.
        if (std::norm(alike.values()(0)) > score.detectable_nm * score.detectable_nm)
            score.detectable_nm = std::numeric_limits<double>::infinity();
        // Amplitudes beyond the noise that follow no form tried may be a ripple of another form.
        const double over = score.order < one_sided_below ? certain_over_noise_above : certain_over_noise;
        const bool certain = score.ripple_nm * score.ripple_nm >= over * score.noise_nm * score.noise_nm;
        unclear = unclear || certain || !std::isfinite(score.detectable_nm);
    }
    fit.finding = mapped ? MapFinding::mapped : unclear ? MapFinding::unclear : MapFinding::nothing;
}

constexpr double errors_apart = 3.0;       // chosen, not derived: three standard errors
constexpr double share_apart = 0.15;       ///< a smaller difference is no reason against a map
constexpr double ripple_over_noise = 2.0;  ///< squares of an order that an oscillator may follow

// The factor between the ripple of one log and its prediction by a map of the others, and its error by
// blocks.
MapAgreement agreement_of(const MapRegression& fit, const std::vector<bool>& of_log, std::size_t log,
                          double order) {
    const Eigen::VectorXcd others = fit.values(of_log);
    std::complex<double> alike = 0.0;
    double expected = 0.0, square = 0.0;
    const auto each_block = [&](const auto& take) {
        for (std::size_t b = 0; b < of_log.size(); ++b)
            if (of_log[b]) take(fit.products(b, others));
    };
    each_block([&](const auto& block) {
        alike += block.first;
        expected += block.second;
    });
    MapAgreement found{log, order};
    if (!(expected > 0.0)) return found;
    const std::complex<double> factor = alike / expected;
    each_block([&](const auto& block) { square += 0.5 * std::norm(block.first - factor * block.second); });
    // Not below the error of each part from noise alone.
    const double error = std::sqrt(1.0 / expected + square / (expected * expected));
    const double size = portable::hypot(factor.real(), factor.imag());
    found.amplitude_ratio = size;
    found.amplitude_error = error;
    // z = A exp(-i phase): a phase that is ahead turns z backward.
    found.phase_deg = -portable::arg(factor) * degrees_per_radian;
    found.phase_error_deg = size > error ? portable::asin(error / size) * degrees_per_radian : 180.0;
    const double apart = portable::hypot(factor.real() - 1.0, factor.imag());
    found.agrees = apart <= std::max(errors_apart * std::numbers::sqrt2 * error, share_apart);
    return found;
}

void hold_logs_together(const MapData& data, const MapForm& form, std::size_t logs, MapFit& fit) {
    for (std::size_t l = 0; logs > 1 && l < logs; ++l) {
        std::vector<bool> of_log(data.blocks);
        for (const MapWindow& window : data.windows) of_log[window.block] = window.log == l;
        if (std::adjacent_find(of_log.begin(), of_log.end(), std::not_equal_to<>()) == of_log.end()) continue;
        for (std::size_t i = 0; i < fit.scores.size(); ++i) {
            if (!fit.scores[i].in_map) continue;
            fit.agreement.push_back(
                agreement_of(MapRegression(data, form, i), of_log, l, fit.scores[i].order));
        }
    }
}

// An order whose ripple is there and follows no form stays in the map with no amplitude, for who follows it.
void fill_map(const MapData& data, const MapForm& form, MapFit& fit) {
    fit.map = data.frame;
    fit.map.form = form;
    fit.map.orders.clear();
    for (std::size_t i = 0; i < fit.scores.size(); ++i) {
        const MapOrderScore& score = fit.scores[i];
        const double noise = score.noise_nm * score.noise_nm;
        const double all = score.ripple_nm * score.ripple_nm;
        if (!score.in_map && all < ripple_over_noise * noise) continue;
        const double left = score.in_map ? score.left_nm * score.left_nm : all;
        const MapRegression regression(data, form, i);
        fit.map.orders.push_back(data.frame.orders[i]);
        fit.map.spread_nm.push_back(std::sqrt(std::max(left - noise, 0.01 * left)));
        fit.errors.push_back(regression.errors());
        const Eigen::VectorXcd values = regression.values();
        fit.map.values.emplace_back(values.begin(), values.end());
        if (!score.in_map) fit.map.values.back().assign(form.columns(), 0.0);
    }
}

double decibels_down(double from_nm, double to_nm) {
    return to_nm > 0.0 && from_nm > 0.0 ? 20.0 * portable::log10(from_nm / to_nm) : 0.0;
}

std::string orders_of(const std::vector<MapOrderScore>& scores) {
    return (scores.size() == 1 ? "order " : "orders ") +
           joined(scores, ", ", [](const MapOrderScore& score) { return shortest(score.order); });
}

std::string disagreement(const MapAgreement& one) {
    if (one.agrees) return "";
    return fmt::format("in log {} order {} is {:.2f} times as large and {:.0f} deg ahead", one.log + 1,
                       shortest(one.order), one.amplitude_ratio, std::round(one.phase_deg) + 0.0);
}

std::string mapped_order(const MapOrderScore& score) {
    if (!score.in_map) return "";
    return fmt::format("order {} falls from {:.3g} to {:.3g} Nm ({:.1f} dB; noise limit {:.1f} dB)",
                       shortest(score.order), score.ripple_nm, score.left_nm,
                       decibels_down(score.ripple_nm, score.left_nm),
                       decibels_down(score.ripple_nm, score.noise_nm));
}

std::string bound_of(const MapOrderScore& score) {
    if (score.in_map || !std::isfinite(score.detectable_nm) || !(score.detectable_nm > 0.0)) return "";
    return fmt::format("{:.2g} Nm of order {}", score.detectable_nm, shortest(score.order));
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
    choose_map(data, map_false_alarm, fit);
    const MapForm form = fit.map.form;
    if (fit.finding == MapFinding::mapped) fill_map(data, form, fit);
    hold_logs_together(data, form, logs.size(), fit);
    const bool agree = std::all_of(fit.agreement.begin(), fit.agreement.end(),
                                   [](const MapAgreement& one) { return one.agrees; });
    fit.conclusive = fit.anchored && fit.finding != MapFinding::unclear && agree;
    return fit;
}

std::string_view map_finding_name(MapFinding finding) {
    constexpr std::array<std::string_view, 4> names = {"mapped", "nothing", "unclear", "too-little"};
    return names[static_cast<std::size_t>(finding)];
}

std::string map_form_words(const MapForm& form) {
    const bool by_speed = form.speeds_deg_s.size() > 1, by_direction = form.directions > 1;
    std::string text = by_speed ? fmt::format("by speed ({} of them)", form.speeds_deg_s.size()) : "";
    if (by_direction) text += by_speed ? " and direction" : "by direction";
    if (text.empty()) text = "the same at every speed";
    if (form.second_comb != 0)
        text += fmt::format(", with the second comb at n (Kg {} 1)", form.second_comb > 0 ? '+' : '-');
    if (form.turn_harmonics > 0)
        text += fmt::format(", with {} harmonic{} of the joint's turn", form.turn_harmonics,
                            form.turn_harmonics == 1 ? "" : "s");
    if (form.by_load) text += ", and by load";
    return text + (form.by_temperature ? ", and by temperature" : "");
}

std::string map_column_words(const MapForm& form, std::size_t column) {
    const std::size_t each = form.columns_a_direction(), within = column % each;
    const std::size_t speeds = form.speeds_deg_s.size();
    std::string what;
    if (within < form.speed_columns()) {
        what = speeds > 1 ? fmt::format("{:.4g} deg/s", form.speeds_deg_s[within % speeds]) : "any speed";
        if (within >= speeds) what += ", second comb";
    } else if (within < form.load_column()) {
        const std::size_t at = within - form.speed_columns();
        what = fmt::format("{} of {} joint angle{}", at % 2 == 0 ? "cosine" : "sine", at / 2 + 1,
                           at / 2 == 0 ? "" : "s");
    } else {
        what = form.by_load && within == form.load_column() ? "per Nm of load" : "per degC beyond the middle";
    }
    if (form.directions == 1) return what;
    return (column < each ? "forward, " : "backward, ") + what;
}

std::string map_verdict(const MapFit& fit) {
    std::vector<std::string> sentences = {fit.doubt};
    const std::string ratio = fmt::format("{} at gear ratio {:.6g} in {} windows", orders_of(fit.scores),
                                          fit.map.gear_ratio.value(), fit.windows);
    if (fit.finding == MapFinding::too_little) {
        sentences.push_back(
            fmt::format("Cannot tell: the motor turns 2.5 times in one direction in {} windows, and {} are "
                        "needed to leave "
                        "some out; the map is empty.",
                        fit.windows, fewest_map_windows));
    } else if (fit.finding == MapFinding::nothing) {
        sentences.push_back(fmt::format("No ripple found of {}: the map is empty.", ratio));
    } else if (fit.finding == MapFinding::unclear) {
        sentences.push_back(
            fmt::format("Cannot tell: no regular ripple found of {}, but amplitudes above the noise, or no "
                        "bound; the map is "
                        "empty.",
                        ratio));
    } else {
        sentences.push_back(fmt::format("Cross-validated: {}; amplitudes {}.",
                                        joined(fit.scores, ", ", mapped_order),
                                        map_form_words(fit.map.form)));
    }
    if (const std::string bounds = joined(fit.scores, ", ", bound_of); !bounds.empty())
        sentences.push_back(fmt::format("An amplitude of {} would have been found.", bounds));
    if (!fit.anchored && fit.finding == MapFinding::mapped)
        sentences.emplace_back("The log has no position: phases count from its first row.");
    if (const std::string apart = joined(fit.agreement, ", ", disagreement); !apart.empty())
        sentences.push_back(fmt::format("The logs disagree: {}.", apart));
    if (fit.doubt.empty()) sentences.erase(sentences.begin());
    return fmt::format("{}", fmt::join(sentences, " "));
}

}  // namespace ripplenotch
