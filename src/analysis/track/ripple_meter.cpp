// SPDX-License-Identifier: MIT
#include "ripplenotch/analysis/ripple_meter.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "analysis/shared_limits.hpp"
#include "core/matrices/factorisations.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/median.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/phasor.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

constexpr double turns_wanted = 8.0;         // by hand: of the motor, in a window
constexpr double turns_needed = 4.0;         // by hand: half of what is wanted
constexpr double longest_window_s = 2.0;     ///< beyond, a window ends as soon as it holds what is needed ...
constexpr double slowest_turns_per_s = 0.5;  ///< ... unless the motor turns slower
constexpr double fewest_samples_a_period = 3.0;  // by hand: the sampling theorem asks for two
constexpr double reversal_turns = 0.25;  ///< back from the furthest angle by more: the joint has turned round
constexpr std::size_t parts_of_window = 16;         ///< in each of which the speed counts as constant
constexpr std::size_t most_rows_of_window = 65536;  ///< bounds the memory
constexpr std::size_t most_values_kept = 4096;      ///< values kept for the median

double peak_to_peak_of(const Eigen::VectorXd& values) { return values.maxCoeff() - values.minCoeff(); }

}  // namespace

// A median of any number of values in bounded memory: every stride-th window is kept, and when the store is
// full every second one of those.
struct ThinnedMedian {
    std::vector<double> values;
    std::size_t stride = 1, seen = 0;

    void add(double value) {
        if (seen++ % stride != 0) return;
        values.push_back(value);
        if (values.size() < most_values_kept) return;
        for (std::size_t i = 0; 2 * i < values.size(); ++i) values[i] = values[2 * i];
        values.resize(values.size() / 2);
        stride *= 2;
    }
    [[nodiscard]] double median() const {
        if (values.empty()) return 0.0;
        auto sorted = values;
        return median_in(sorted);
    }
};

// Sums over windows; amplitudes are weighted by rows.
struct RippleSums {
    std::vector<double> amplitude_squared;  ///< [order * signals + signal]
    std::vector<double> expected_squared;   ///< [order], of gains
    std::vector<double> residual_squared;   ///< [signal]
    std::vector<ThinnedMedian> peak_to_peak;
    std::vector<double> ripple_peak_to_peak;
    double turns = 0.0, seconds = 0.0;
    std::size_t windows = 0, rows = 0, steps = 0, too_few_samples = 0, too_slow = 0;
};

struct RippleMeter::State {
    double ratio;
    std::vector<double> orders;
    std::size_t signals;
    std::size_t most_rows;

    // The window under way: angles in motor turns from its first row, torques row by row.
    std::vector<double> turns, torque_nm, time_s;
    double furthest = 0.0;
    bool has_last = false;
    double last_velocity = 0.0, last_position = 0.0, last_s = 0.0;
    std::size_t seen = 0;
    RippleSums sums;
    LineGains gains;

    [[nodiscard]] double turned(double step_s, double velocity_deg_s, const double* position_deg) const {
        double moved_deg = 0.0;
        if (position_deg != nullptr) {
            moved_deg = *position_deg - last_position;
            if (std::abs(moved_deg) > 180.0) moved_deg -= 360.0 * std::round(moved_deg / 360.0);
        } else {
            moved_deg = 0.5 * (last_velocity + velocity_deg_s) * step_s;
        }
        return ratio * moved_deg / 360.0;
    }

    void begin(double now_s, std::span<const double> torque) {
        turns.assign(1, 0.0);
        time_s.assign(1, now_s);
        torque_nm.assign(torque.begin(), torque.end());
        furthest = 0.0;
    }

    void add(double now_s, double velocity_deg_s, const double* position_deg,
             std::span<const double> torque) {
        ++seen;
        if (!has_last) {
            begin(now_s, torque);
        } else {
            const double angle = turns.back() + turned(now_s - last_s, velocity_deg_s, position_deg);
            const double back = furthest < 0.0 ? angle - furthest : furthest - angle;
            if (back > reversal_turns) {
                close(sums);
                begin(now_s, torque);
            } else if (turns.size() >= most_rows && ends_late(now_s)) {
                // A joint that stands still has no ripple to measure and is not worth a word.
                if (!close(sums) && std::abs(furthest) > reversal_turns) ++sums.too_slow;
                begin(now_s, torque);
            } else {
                turns.push_back(angle);
                time_s.push_back(now_s);
                torque_nm.insert(torque_nm.end(), torque.begin(), torque.end());
                if (std::abs(angle) > std::abs(furthest)) furthest = angle;
                if (std::abs(angle) >= turns_wanted) {
                    measure(turns.size(), sums);
                    begin(now_s, torque);
                }
            }
        }
        has_last = true;
        last_velocity = velocity_deg_s;
        last_s = now_s;
        if (position_deg != nullptr) last_position = *position_deg;
    }

    // A window that has lasted long enough ends where it holds what is needed, or never will.
    [[nodiscard]] bool ends_late(double now_s) const {
        return std::abs(furthest) >= turns_needed ||
               std::abs(furthest) < slowest_turns_per_s * (now_s - time_s.front()) ||
               turns.size() >= most_rows_of_window;
    }

    // A window that ends early still counts up to its last whole turn, if there are enough of them.
    bool close(RippleSums& into) const {
        const double whole = std::floor(std::abs(furthest));
        if (whole < turns_needed) return false;
        std::size_t rows = 0;
        while (rows < turns.size() && std::abs(turns[rows]) < whole) ++rows;
        measure(std::min(rows + 1, turns.size()), into);
        return true;
    }

    void measure(std::size_t rows, RippleSums& into) const;
    void expect_in(std::size_t rows, RippleSums& into) const;
};

// What the fit of a window sees is the mean of the filtered line's amplitude and phase over it.
void RippleMeter::State::expect_in(std::size_t rows, RippleSums& into) const {
    const std::size_t parts = std::min(parts_of_window, rows - 1);
    const double step_s = (time_s[rows - 1] - time_s.front()) / static_cast<double>(rows - 1);
    std::vector<std::complex<double>> now(orders.size());
    auto mean = now;
    for (std::size_t part = 0; part < parts; ++part) {
        const std::size_t first = (rows - 1) * part / parts, last = (rows - 1) * (part + 1) / parts;
        const double seconds = step_s * static_cast<double>(last - first);
        gains(std::abs(turns[last] - turns[first]) * 360.0 / ratio / seconds, now);
        for (std::size_t i = 0; i < mean.size(); ++i) mean[i] += now[i] / static_cast<double>(parts);
    }
    for (std::size_t i = 0; i < mean.size(); ++i)
        into.expected_squared[i] += static_cast<double>(rows) * std::norm(mean[i]);
}

// Fits all signals over the first `rows` rows of the window under way.
void RippleMeter::State::measure(std::size_t rows, RippleSums& into) const {
    const double turned_by = std::abs(turns[rows - 1]);
    const double highest = *std::max_element(orders.begin(), orders.end());
    const auto n = static_cast<Eigen::Index>(rows);
    const auto columns = window_trend_terms + static_cast<Eigen::Index>(2 * orders.size());
    if (static_cast<double>(rows - 1) < fewest_samples_a_period * highest * turned_by || n < 2 * columns) {
        ++into.too_few_samples;
        return;
    }
    Eigen::MatrixXd basis(n, columns);
    for (Eigen::Index k = 0; k < n; ++k) {
        const double s = 2.0 * static_cast<double>(k) / static_cast<double>(n - 1) - 1.0;
        double power = 1.0;
        for (Eigen::Index i = 0; i < window_trend_terms; ++i, power *= s) basis(k, i) = power;
        for (std::size_t i = 0; i < orders.size(); ++i) {
            const double phase = 2.0 * std::numbers::pi * orders[i] * turns[static_cast<std::size_t>(k)];
            const std::complex<double> phasor = portable::phasor(phase);
            basis(k, window_trend_terms + static_cast<Eigen::Index>(2 * i)) = phasor.real();
            basis(k, window_trend_terms + static_cast<Eigen::Index>(2 * i + 1)) = phasor.imag();
        }
    }
    const Eigen::MatrixXd normal = basis.transpose() * basis;
    const SymmetricFactors solver(normal);
    const auto count = static_cast<Eigen::Index>(signals);
    const Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>> torque(
        torque_nm.data(), n, count);
    const Eigen::MatrixXd right = basis.transpose() * torque;
    const Eigen::MatrixXd fitted = solver.solve(right);
    const double weight = static_cast<double>(rows);
    for (std::size_t j = 0; j < signals; ++j) {
        const auto column = static_cast<Eigen::Index>(j);
        for (std::size_t i = 0; i < orders.size(); ++i) {
            const auto row = window_trend_terms + static_cast<Eigen::Index>(2 * i);
            into.amplitude_squared[i * signals + j] +=
                weight * (portable::pow(fitted(row, column), 2) + portable::pow(fitted(row + 1, column), 2));
        }
        const Eigen::VectorXd detrended =
            torque.col(column) -
            basis.leftCols(window_trend_terms) * fitted.col(column).head(window_trend_terms);
        const Eigen::VectorXd ripple = basis.rightCols(columns - window_trend_terms) *
                                       fitted.col(column).tail(columns - window_trend_terms);
        into.residual_squared[j] += detrended.squaredNorm();
        into.peak_to_peak[j].add(peak_to_peak_of(detrended));
        into.ripple_peak_to_peak[j] = std::max(into.ripple_peak_to_peak[j], peak_to_peak_of(ripple));
    }
    if (gains) expect_in(rows, into);
    into.turns += turned_by;
    into.seconds += time_s[rows - 1] - time_s.front();
    into.rows += rows;
    into.steps += rows - 1;  // the last row of a window is the first of the next
    ++into.windows;
}

RippleMeter::RippleMeter(GearRatio ratio, std::span<const Order> orders, Hertz sample_rate,
                         std::size_t signals) {
    if (!(ratio.value() > 0.0)) raise<UsageError>("gear ratio {} is not above 0", shortest(ratio.value()));
    if (!(sample_rate.value() > 0.0)) {
        raise<UsageError>("sample rate {} Hz is not above 0 Hz", shortest(sample_rate.value()));
    }
    if (orders.empty() || signals == 0)
        raise<UsageError>("measuring ripple needs at least one order and one signal");
    state_ = std::make_unique<State>();
    for (const Order order : orders) {
        if (!(order.value() > 0.0)) raise<UsageError>("order {} is not above 0", shortest(order.value()));
        state_->orders.push_back(order.value());
    }
    state_->ratio = ratio.value();
    state_->signals = signals;
    state_->most_rows = static_cast<std::size_t>(
        std::clamp(longest_window_s * sample_rate.value(), 64.0, static_cast<double>(most_rows_of_window)));
    state_->sums.amplitude_squared.resize(orders.size() * signals);
    state_->sums.expected_squared.resize(orders.size());
    state_->sums.residual_squared.resize(signals);
    state_->sums.peak_to_peak.resize(signals);
    state_->sums.ripple_peak_to_peak.resize(signals);
}

RippleMeter::~RippleMeter() = default;
RippleMeter::RippleMeter(RippleMeter&&) noexcept = default;
RippleMeter& RippleMeter::operator=(RippleMeter&&) noexcept = default;

void RippleMeter::add(Seconds time, double velocity_deg_s, const double* position_deg,
                      std::span<const double> torque_nm) {
    state_->add(time.value(), velocity_deg_s, position_deg, torque_nm);
}

void RippleMeter::expect(LineGains gains) { state_->gains = std::move(gains); }

void RippleMeter::split() {
    if (state_->has_last) static_cast<void>(state_->close(state_->sums));
    state_->has_last = false;
}

RippleLevels RippleMeter::levels() const {
    RippleSums sums = state_->sums;
    if (state_->has_last) static_cast<void>(state_->close(sums));
    const double rows = static_cast<double>(std::max<std::size_t>(sums.rows, 1));
    RippleLevels levels;
    for (std::size_t i = 0; i < state_->orders.size(); ++i) {
        OrderLevel level;
        level.order = state_->orders[i];
        if (sums.seconds > 0.0) level.mean_hz = level.order * sums.turns / sums.seconds;
        for (std::size_t j = 0; j < state_->signals; ++j) {
            level.amplitude_nm.push_back(std::sqrt(sums.amplitude_squared[i * state_->signals + j] / rows));
        }
        if (state_->gains && sums.windows > 0)
            level.expected_gain = std::sqrt(sums.expected_squared[i] / rows);
        levels.orders.push_back(std::move(level));
    }
    for (std::size_t j = 0; j < state_->signals; ++j) {
        levels.residual_rms_nm.push_back(std::sqrt(sums.residual_squared[j] / rows));
        levels.residual_peak_to_peak_nm.push_back(sums.peak_to_peak[j].median());
        levels.ripple_peak_to_peak_nm.push_back(sums.ripple_peak_to_peak[j]);
    }
    levels.windows = sums.windows;
    levels.windows_too_few_samples = sums.too_few_samples;
    levels.windows_too_slow = sums.too_slow;
    if (state_->seen > 1) {
        levels.measured_share = static_cast<double>(sums.steps) / static_cast<double>(state_->seen - 1);
    }
    return levels;
}

}  // namespace ripplenotch
