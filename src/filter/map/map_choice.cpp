// SPDX-License-Identifier: MIT
#include "filter/map/map_choice.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "filter/map/map_regression.hpp"
#include "ripplenotch/core/phasor.hpp"
#include "ripplenotch/core/portable_math.hpp"
#include "ripplenotch/filter/map_fit.hpp"

namespace ripplenotch {
namespace {

using Eigen::MatrixXcd, Eigen::MatrixXd;

constexpr double least_warming_degc = 1.0;        ///< a narrower range does not determine what a degree does
constexpr std::size_t most_harmonics = 3;         // by hand
constexpr std::size_t surrogates_an_order = 200;  ///< twice what the smallest level of the test resolves
// Orders that are compared with: so far to both sides, beyond what the joint's turn modulates. Of ten that
// are independent, noise at the order is twice the largest once in 66 logs (exponential variables).
constexpr double nearest_order = 0.1, order_span = 0.3, farthest_start = 0.3;
constexpr int compared_orders = 15;
constexpr double above_neighbours = 2.0;
constexpr std::size_t injections = 20;
constexpr double injection_step = 1.25;
constexpr double most_injected = 10.0;  ///< times the rms amplitude: a test that misses this has no power
constexpr double least_errors_better = 2.0;  ///< by which a map has to be better than none

/// How an amplitude depends on the joint's angle.
struct Angle {
    std::size_t harmonics;
    int second_comb;
};

std::vector<double> spread_speeds(const MapRange& range, std::size_t count) {
    if (count == 1 || !(range.to > range.from)) return {range.middle()};
    std::vector<double> speeds;
    for (std::size_t k = 0; k < count; ++k) {
        speeds.push_back(range.from +
                         (range.to - range.from) * static_cast<double>(k) / static_cast<double>(count - 1));
    }
    return speeds;
}

std::vector<MapForm> forms_of(const MapData& data, std::initializer_list<std::size_t> speed_counts,
                              const std::vector<Angle>& angles) {
    std::vector<MapForm> forms;
    for (const std::size_t speeds : speed_counts) {
        const std::vector<double> knots = spread_speeds(data.speeds_deg_s, speeds);
        if (knots.size() != speeds) continue;
        for (const std::size_t directions : {1U, 2U})
            for (const Angle& angle : angles)
                forms.push_back({knots, directions, angle.harmonics, false, false, angle.second_comb});
    }
    return forms;
}

std::vector<MapForm> candidate_forms(const MapData& data, bool tied) {
    std::vector<Angle> angles = {{0, 0}};
    if (tied) angles.insert(angles.end(), {{0, 1}, {0, -1}});
    for (std::size_t k = 1; tied && k <= most_harmonics; ++k) angles.push_back({k, 0});
    const bool loaded = data.loads_nm.to > data.loads_nm.from;
    const bool warms = data.temperatures_degc.to - data.temperatures_degc.from > least_warming_degc;
    std::vector<MapForm> forms;
    for (MapForm form : forms_of(data, {1, 2, 3, 5}, angles)) {
        for (const bool by_load : {false, true}) {
            for (const bool by_temperature : {false, true}) {
                if ((by_load && !loaded) || (by_temperature && !warms)) continue;
                form.by_load = by_load;
                form.by_temperature = by_temperature;
                forms.push_back(form);
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
double least_reduction(double level = map_false_alarm) { return -2.0 * portable::log(level); }

// The mean over its standard error.
double in_errors(const Eigen::ArrayXd& by_block) {
    const double blocks = static_cast<double>(by_block.size()), mean = by_block.mean();
    const double square = (by_block - mean).square().sum() / std::max(blocks * (blocks - 1.0), 1.0);
    return square > 0.0 ? mean / std::sqrt(square) : 0.0;
}

double reduction_of(const MapData& data, const MapForm& form, std::size_t order) {
    return MapRegression(data, frame_of(data, form, 0.0), order).reduction().sum().real();
}

// Leakage of a torque that repeats with the joint's position has the same phase in all sweeps, and so at
// every order nearby. A line of the motor has not: the same amplitudes turned by another order's angle
// cancel.
bool stands_above_neighbours(const MapData& data, const MapForm& form, std::size_t order) {
    const double ratio = data.gear_ratio.value();
    const double start = std::min(nearest_order + data.orders[order].value() / ratio, farthest_start);
    const double own = reduction_of(data, form, order);
    for (int k = 0; k < 2 * compared_orders; ++k) {
        const double aside = (k % 2 == 0 ? 1.0 : -1.0) * (start + order_span * (k / 2) / compared_orders);
        MapData turned = data;
        for (MapWindow& window : turned.windows) {
            const double cycles = aside * ratio * window.state.position_deg / 360.0;
            window.value[order] *= portable::phasor(2.0 * std::numbers::pi * (cycles - std::floor(cycles)));
        }
        if (own < above_neighbours * reduction_of(turned, form, order)) return false;
    }
    return true;
}

/// Rotation test of one order. What is not locked to the motor has in each block of a log a phase of its own:
/// logs whose blocks are turned at random are draws of the null hypothesis, whatever its noise is. Beyond any
/// of them counts even with four blocks, since four random phases are hardly alike. The statistic is the
/// reduction of left-out squares, in deviations of its draws, largest of a few forms.
class RotationTest {
  public:
    RotationTest(const MapData& data, bool tied, std::size_t draws)
        : forms_(forms_of(data, {1, 3, 5},
                          tied ? std::vector<Angle>{{0, 0}, {0, 1}, {0, -1}} : std::vector<Angle>{{0, 0}})),
          phasors_(random_phasors(data.blocks, draws + 1, 20)) {
        phasors_.col(0).setOnes();
    }
    /// The false-alarm probability: the share of draws that are as large, the log itself counted. 1 where the
    /// noise beside the order alone may be as large (chi-square of two degrees of freedom at `level`), or
    /// where the order is no line among its neighbours.
    [[nodiscard]] double false_alarm(const MapData& data, std::size_t order, double level) const {
        Eigen::ArrayXd largest = Eigen::ArrayXd::Constant(phasors_.cols(), -1e300);
        double most = 0.0;
        std::size_t best = 0;
        for (std::size_t f = 0; f < forms_.size(); ++f) {
            const MatrixXcd reduction =
                MapRegression(data, frame_of(data, forms_[f], 0.0), order).reduction();
            const MatrixXcd turned = phasors_.conjugate().cwiseProduct(reduction * phasors_);
            const Eigen::ArrayXd squares = turned.colwise().sum().real().transpose().array();
            const Eigen::ArrayXd beyond = squares - squares.mean();
            const double spread = std::sqrt(beyond.square().mean());
            most = std::max(most, squares(0));
            if (!(spread > 0.0)) continue;
            if (beyond(0) / spread > largest(0)) best = f;
            largest = largest.max(beyond / spread);
        }
        if (!(most > least_reduction(level))) return 1.0;
        const double share =
            static_cast<double>((largest >= largest(0)).count()) / static_cast<double>(largest.size());
        if (share > other_order_false_alarm || stands_above_neighbours(data, forms_[best], order))
            return share;
        return 1.0;
    }

  private:
    std::vector<MapForm> forms_;
    MatrixXcd phasors_;
};

// At most 1 % of logs without ripple give a map. Beside an order that is there any other is tested by itself.
std::vector<bool> present_orders(const std::vector<double>& false_alarm) {
    const double least = *std::min_element(false_alarm.begin(), false_alarm.end());
    const bool any = least <= map_false_alarm / static_cast<double>(false_alarm.size());
    std::vector<bool> present;
    for (const double one : false_alarm) present.push_back(any && one <= other_order_false_alarm);
    return present;
}

/// The residuals of a form: of each order, and of the orders that have a say.
struct FormTrial {
    MapForm form;
    std::vector<MatrixXd> by_order;
    MatrixXd sum;
};

// The smallest form whose squares are those of the best but for what noise alone reduces them by: a form that
// shrinks where the log determines little costs little, so that a standard error over a few blocks, which
// differ by their ripple, would be too much. `left_out` has no say; the number of blocks for none.
std::size_t smallest_good(const std::vector<FormTrial>& trials, Eigen::Index left_out) {
    const Eigen::Index blocks = trials.front().sum.rows();
    const auto row = [&](const FormTrial& trial) -> Eigen::ArrayXd {
        Eigen::ArrayXd squares = left_out < blocks ? Eigen::ArrayXd(trial.sum.row(left_out).transpose())
                                                   : Eigen::ArrayXd(trial.sum.diagonal());
        if (left_out < blocks) squares(left_out) = 0.0;
        return squares;
    };
    std::size_t best = 0;
    for (std::size_t f = 1; f < trials.size(); ++f)
        if (row(trials[f]).sum() < row(trials[best]).sum()) best = f;
    const double enough = row(trials[best]).sum() + least_reduction();
    for (std::size_t f = 0; f < best; ++f)
        if (row(trials[f]).sum() <= enough) return f;
    return best;
}

std::string note_on(const FormTrial& trial, double total, std::string_view what) {
    return fmt::format("{}: {} leaves {:.1f} % of the squares of left-out blocks", what,
                       map_form_words(trial.form), total > 0.0 ? 100.0 * trial.sum.trace() / total : 0.0);
}

void choose_form(const MapData& data, std::vector<FormTrial> trials, MapChoice& choice) {
    const auto count = static_cast<Eigen::Index>(data.blocks);
    for (FormTrial& trial : trials) {
        const RippleMap frame = frame_of(data, trial.form, 0.0);
        trial.sum = MatrixXd::Zero(count, count);
        for (std::size_t i = 0; i < data.orders.size(); ++i) {
            trial.by_order.push_back(MapRegression(data, frame, i).residuals());
            if (choice.present[i]) trial.sum += trial.by_order.back();
        }
    }
    const FormTrial& chosen = trials[smallest_good(trials, count)];
    choice.form = chosen.form;
    double total = 0.0, residual = 0.0;
    for (std::size_t i = 0; i < data.orders.size(); ++i) {
        const MapRegression regression(data, frame_of(data, chosen.form, 0.0), i);
        HeldOut held;
        double weights = 0.0;
        Eigen::ArrayXd better(count);
        for (Eigen::Index b = 0; b < count; ++b) {
            const BlockSquares squares = regression.squares(static_cast<std::size_t>(b));
            held.total += squares.total;
            held.noise += squares.noise;
            weights += squares.weights;
            const double left = trials[smallest_good(trials, b)].by_order[i](b, b);
            held.residual += left;
            better(b) = squares.total - left;
        }
        choice.errors_better.push_back(in_errors(better));
        if (choice.present[i]) {
            total += held.total;
            residual += held.residual;
        }
        if (weights > 0.0) held = {held.total / weights, held.noise / weights, held.residual / weights};
        choice.held_out.push_back(held);
    }
    const auto best = std::min_element(trials.begin(), trials.end(), [](const auto& a, const auto& b) {
        return a.sum.trace() < b.sum.trace();
    });
    choice.notes = {note_on(trials.front(), total, "the simplest form"),
                    note_on(*best, total, fmt::format("the best of {} forms", trials.size())),
                    note_on(chosen, total, "taken")};
    if (total > 0.0)
        choice.notes.push_back(
            fmt::format("with forms that did not see the block: {:.1f} %", 100.0 * residual / total));
}

}  // namespace

MapChoice choose_map(const MapData& data, bool tied) {
    MapChoice choice;
    const std::size_t orders = data.orders.size();
    const RotationTest test(data, tied, surrogates_an_order * orders - 1);
    for (std::size_t i = 0; i < orders; ++i)
        choice.false_alarm.push_back(
            test.false_alarm(data, i, map_false_alarm / static_cast<double>(orders)));
    choice.present = present_orders(choice.false_alarm);
    std::vector<FormTrial> trials;
    const bool any = std::find(choice.present.begin(), choice.present.end(), true) != choice.present.end();
    for (const MapForm& form : candidate_forms(data, tied)) {
        trials.push_back({form, {}, {}});
        if (!any) break;
    }
    choose_form(data, std::move(trials), choice);
    bool mapped = false;
    for (std::size_t i = 0; i < orders; ++i) {
        mapped = mapped || (choice.false_alarm[i] <= map_false_alarm / static_cast<double>(orders) &&
                            choice.errors_better[i] > least_errors_better);
    }
    for (std::size_t i = 0; i < orders; ++i)
        choice.present[i] = mapped && choice.present[i] && choice.errors_better[i] > 0.0;
    return choice;
}

double detectable_amplitude(const MapData& all, std::size_t order, bool tied) {
    const MapData data = of_order(all, order);
    const double level = map_false_alarm / static_cast<double>(all.orders.size());
    const RotationTest test(data, tied, surrogates_an_order * all.orders.size() - 1);
    const MatrixXcd phasors = random_phasors(data.blocks + 1, injections, 21);
    const auto found = [&](double amplitude_nm, Eigen::Index trial) {
        MapData injected = data;
        for (MapWindow& window : injected.windows) {
            window.value[0] *= phasors(static_cast<Eigen::Index>(window.block), trial);
            window.value[0] += amplitude_nm * phasors(phasors.rows() - 1, trial);
        }
        summarise(injected);
        const MapRegression alike(injected, frame_of(injected, {{data.speeds_deg_s.middle()}}, 0.0), 0);
        Eigen::ArrayXd better = -alike.residuals().diagonal().array();
        for (std::size_t b = 0; b < data.blocks; ++b)
            better(static_cast<Eigen::Index>(b)) += alike.squares(b).total;
        return in_errors(better) > least_errors_better && test.false_alarm(injected, 0, level) <= level;
    };
    const double most_nm = most_injected * std::sqrt(data.energy[0]);
    double amplitude_nm = std::sqrt(data.mean_noise[0] / static_cast<double>(data.windows.size()));
    for (; amplitude_nm < most_nm; amplitude_nm *= injection_step) {
        Eigen::Index seen = 0;
        while (seen < phasors.cols() && found(amplitude_nm, seen)) ++seen;
        if (seen == phasors.cols()) return amplitude_nm;
    }
    return std::numeric_limits<double>::infinity();
}

}  // namespace ripplenotch
