// SPDX-License-Identifier: MIT
#include "diagnose/setup/lag.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "core/matrices/least_squares.hpp"
#include "core/rows/row_facts.hpp"
#include "diagnose/engine/gram.hpp"
#include "diagnose/engine/recorded_motion.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {

using Eigen::Index, Eigen::MatrixXd, Eigen::VectorXd;

namespace {

// Half the width of the window: ripple above 16 Hz is attenuated by 25 dB at least.
constexpr double half_window_s = 0.05;
constexpr double longest_s = 1.0,
                 longest_share = 0.1;  // delays that are searched, of the log where that is less
constexpr double freedom = static_cast<double>(BlockProducts::blocks - 1);
constexpr double clock_quantile = 4.781;  // Student's t at 0.9995 for that freedom
// Of the variance of blocks held out. Of 100 pairs of unrelated motions 7 reached it, 3 of which had one lag.
// Of a reversed one, and of a torque by a motion, far more.
constexpr double least_share = 0.5, least_of_all = 0.9;
// Half a period of a sine reverses its sign: such a lag has to leave so much less, in squares.
constexpr double reversed_ratio = 4.0;
// Two steps of Coulomb friction follow one of a width between: with one of 2 deg/s the lag was off by 1.8 ms.
constexpr std::array step_widths_deg_s = {1.0, 8.0};
constexpr double loop_width_deg = 2.0;
// Of a friction that the motion makes and no delay has blurred: without these a command's delay was off
// by 1.5 ms, and viscous friction by that times the gain of the law.
constexpr std::array sharp_widths_deg_s = {0.25, 4.0};
constexpr double sharp_loop_deg = 0.1;
// Of the misfit as a delay, to the interval of a torque's lag: blocks do not show an effect that neither the
// simulation nor a column has. 54 of 57 intervals then covered the delay, and 48 without it.
constexpr double misfit_share = 0.25;

double sum_of(const std::vector<double>& values) {
    return std::accumulate(values.begin(), values.end(), 0.0);
}

}  // namespace

SmoothedSeries::SmoothedSeries(std::span<const double> time_s, std::span<const double> value,
                               double half_width_s)
    : time_s_(time_s), value_(value.begin(), value.end()), width_s_(half_width_s) {
    // About its mean: the second integral grows with the square of time.
    mean_ = sum_of(value_) / static_cast<double>(value_.size());
    for (double& each : value_) each -= mean_;
    once_.assign(value_.size(), 0.0);
    twice_.assign(value_.size(), 0.0);
    const double longest_s = std::max(width_s_, 3.0 * usual_step_s(time_s_));
    for (std::size_t k = 1; k < value_.size(); ++k) {
        const double step_s = time_s_[k] - time_s_[k - 1];
        if (step_s > longest_s) gaps_s_.emplace_back(time_s_[k - 1], time_s_[k]);
        once_[k] = once_[k - 1] + 0.5 * step_s * (value_[k - 1] + value_[k]);
        twice_[k] =
            twice_[k - 1] + step_s * (once_[k - 1] + step_s * (value_[k - 1] / 3.0 + value_[k] / 6.0));
    }
}

bool SmoothedSeries::covers(double at_s) const {
    if (at_s - width_s_ < time_s_.front() || at_s + width_s_ > time_s_.back()) return false;
    const auto next = std::upper_bound(gaps_s_.begin(), gaps_s_.end(), at_s - width_s_,
                                       [](double t, const auto& gap) { return t < gap.second; });
    return next == gaps_s_.end() || next->first >= at_s + width_s_;
}

double SmoothedSeries::integral(int times, double at_s) const {
    const auto next = std::upper_bound(time_s_.begin(), time_s_.end(), at_s) - time_s_.begin();
    const auto k =
        std::min(static_cast<std::size_t>(std::max<std::ptrdiff_t>(next - 1, 0)), value_.size() - 2);
    const double t = at_s - time_s_[k];
    const double slope = (value_[k + 1] - value_[k]) / (time_s_[k + 1] - time_s_[k]);
    if (times == 0) return value_[k] + t * slope;
    if (times == 1) return once_[k] + t * (value_[k] + 0.5 * t * slope);
    return twice_[k] + t * (once_[k] + t * (0.5 * value_[k] + t * slope / 6.0));
}

double SmoothedSeries::mean(double at_s, int derivative) const {
    const int times = 2 - derivative;
    const double second =
        integral(times, at_s + width_s_) - 2.0 * integral(times, at_s) + integral(times, at_s - width_s_);
    return (derivative == 0 ? mean_ : 0.0) + second / (width_s_ * width_s_);
}

std::vector<double> SmoothedSeries::times_s() const {
    std::vector<double> times;
    const double first_s = time_s_.front() + width_s_;
    for (double k = 0.0; first_s + 0.5 * k * width_s_ + width_s_ <= time_s_.back(); k += 1.0)
        if (covers(first_s + 0.5 * k * width_s_)) times.push_back(first_s + 0.5 * k * width_s_);
    return times;
}

BlockProducts::BlockProducts(const Columns& columns, std::span<const double> weight) {
    const std::vector<std::span<const double>> spans(columns.begin(), columns.end());
    const double all = std::accumulate(weight.begin(), weight.end(), 0.0);
    std::vector<std::size_t> block(weight.size());
    double before = 0.0;
    for (std::size_t k = 0; k < weight.size(); ++k) {
        const double share = all > 0.0 ? before / all : 0.0;
        block[k] = std::min(static_cast<std::size_t>(share * static_cast<double>(blocks)), blocks - 1);
        before += weight[k];
    }
    products_.resize(blocks);
    const auto count = static_cast<Index>(columns.size());
    all_ = MatrixXd::Zero(count, count);
    std::vector<unsigned char> use(weight.size());
    for (std::size_t b = 0; b < blocks; ++b) {
        for (std::size_t k = 0; k < use.size(); ++k) use[k] = block[k] == b ? 1 : 0;
        engine::extend_gram(products_[b], spans, use);
        all_ += products_[b];
    }
}

VectorXd BlockProducts::column(Index place) const { return VectorXd::Unit(all_.rows(), place); }

double BlockProducts::squares(const VectorXd& of, const Places& by, bool held_out) const {
    return sum_of(left(of, by, held_out));
}

double BlockProducts::product(const VectorXd& a, const VectorXd& b) const { return a.dot(all_ * b); }

VectorXd BlockProducts::values(const VectorXd& of, const Places& by,
                               std::optional<std::size_t> without) const {
    const MatrixXd products = without ? MatrixXd(all_ - products_[*without]) : all_;
    const auto count = static_cast<Index>(by.size());
    const VectorXd side = products * of;
    MatrixXd gram(count + 1, count + 1);
    gram(0, 0) = of.dot(side);
    for (Index i = 0; i < count; ++i) {
        gram(i + 1, 0) = gram(0, i + 1) = side[by[static_cast<std::size_t>(i)]];
        for (Index j = 0; j < count; ++j)
            gram(i + 1, j + 1) = products(by[static_cast<std::size_t>(i)], by[static_cast<std::size_t>(j)]);
    }
    return engine::solve_normal_equations(gram);
}

std::vector<double> BlockProducts::left(const VectorXd& of, const Places& by, bool held_out) const {
    std::vector<double> squares;
    VectorXd found = values(of, by);
    for (std::size_t b = 0; b < blocks; ++b) {
        if (held_out) found = values(of, by, b);
        VectorXd rest = of;
        for (std::size_t i = 0; i < by.size(); ++i) rest[by[i]] -= found[static_cast<Index>(i)];
        squares.push_back(std::max(rest.dot(products_[b] * rest), 0.0));
    }
    return squares;
}

Alignment::Alignment(std::span<const double> log_s, std::span<const double> left, bool is_slope_of_left,
                     const SimulatedMotion& simulation, std::span<const double> right, bool is_slope_of_right,
                     const TraceView* log, std::optional<GearRatio> gear_ratio)
    : smoothing_s_(
          std::max({half_window_s, 2.0 * usual_step_s(log_s), 2.0 * usual_step_s(simulation.time_s)})),
      range_s_(std::min(longest_s, longest_share * (log_s.back() - log_s.front()))),
      right_(simulation.time_s, right, smoothing_s_),
      derivative_(is_slope_of_right ? 1 : 0),
      rows_(2) {
    const SmoothedSeries measured_series(log_s, left, smoothing_s_);
    const double reach_s = range_s_ + 0.5 * smoothing_s_;
    for (const double t : measured_series.times_s()) {
        bool covered = right_.covers(t - reach_s) && right_.covers(t + reach_s);
        for (double d = -reach_s; d < reach_s && covered; d += smoothing_s_) covered = right_.covers(t - d);
        if (!covered) continue;
        at_s_.push_back(t);
        rows_[0].push_back(measured_series.mean(t, is_slope_of_left ? 1 : 0));
    }
    rows_[1].assign(at_s_.size(), 1.0);
    if (!at_s_.empty()) middle_s_ = 0.5 * (at_s_.front() + at_s_.back());
    if (log != nullptr) add_motion(*log, gear_ratio);
}

void Alignment::add(Places& group, std::span<const double> time_s, std::span<const double> values,
                    int derivative) {
    const SmoothedSeries series(time_s, values, smoothing_s_);
    rows_.emplace_back();
    for (const double t : at_s_) rows_.back().push_back(series.mean(t, derivative));
    group.push_back(static_cast<Index>(rows_.size()) + constant - 2);
}

Places Alignment::add_sharp_friction(const TraceView& log) {
    Places sharp;
    std::vector<double> one(log.size());
    for (const double width_deg_s : sharp_widths_deg_s) {
        for (std::size_t k = 0; k < one.size(); ++k)
            one[k] = portable::tanh(log.velocity_deg_s[k] / width_deg_s);
        add(sharp, log.time_s, one);
    }
    add(sharp, log.time_s, engine::friction_loop(log.position_deg, sharp_loop_deg));
    return sharp;
}

void Alignment::add_motion(const TraceView& log, std::optional<GearRatio> gear_ratio) {
    const std::span<const double> velocity = log.velocity_deg_s;
    const auto add = [&](Places& group, std::span<const double> values, int derivative = 0) {
        this->add(group, log.time_s, values, derivative);
    };
    std::vector<double> angle_deg(log.position_deg.begin(), log.position_deg.end()), one(log.size()),
        other(log.size());
    if (log.has_position()) {
        portable::cos_degrees(angle_deg, one);
        portable::sin_degrees(angle_deg, other);
        add(gravity, one);
        add(gravity, other);
    }
    if (velocity.empty()) return;
    add(inertia, velocity, 1);
    for (const double width_deg_s : step_widths_deg_s) {
        for (std::size_t k = 0; k < one.size(); ++k) one[k] = portable::tanh(velocity[k] / width_deg_s);
        add(friction, one);
        for (std::size_t k = 0; k < one.size(); ++k) one[k] *= std::abs(log.torque_nm[k]);
        if (load.empty()) add(load, one);
    }
    add(friction, velocity);
    if (!log.has_position()) {
        angle_deg.assign(log.size(), 0.0);
        for (std::size_t k = 1; k < angle_deg.size(); ++k)
            angle_deg[k] = angle_deg[k - 1] +
                           0.5 * (log.time_s[k] - log.time_s[k - 1]) * (velocity[k - 1] + velocity[k]);
    }
    add(loop, engine::friction_loop(angle_deg, loop_width_deg));
    if (!gear_ratio) return;
    for (const double order : {1.0, 2.0}) {
        for (const double quarter_deg : {0.0, 90.0}) {
            for (std::size_t k = 0; k < one.size(); ++k)
                one[k] = portable::cos_degrees(order * gear_ratio->value() * angle_deg[k] - quarter_deg);
            add(ripple, one);
            for (std::size_t k = 0; k < one.size(); ++k) one[k] *= std::abs(velocity[k]);
            add(ripple, one);
        }
    }
}

BlockProducts Alignment::products(double delay_s, double clock_error, std::size_t stride) const {
    Columns columns(constant);
    std::vector<double> weight;
    const double near_s = 0.5 * smoothing_s_;
    for (std::size_t k = 0; k < at_s_.size(); k += stride) {
        const double after_middle_s = at_s_[k] - middle_s_,
                     at = at_s_[k] - delay_s - clock_error * after_middle_s;
        const double here = right_.mean(at, derivative_ + 1),
                     before = right_.mean(at - near_s, derivative_ + 1),
                     after = right_.mean(at + near_s, derivative_ + 1);
        const double row[] = {rows_[0][k],    right_.mean(at, derivative_), here, here * after_middle_s,
                              after - before, after - 2.0 * here + before};
        for (std::size_t c = 0; c < columns.size(); ++c) columns[c].push_back(row[c]);
        weight.push_back(here * here);  // what a row tells of the delay
    }
    for (std::size_t c = 1; c < rows_.size(); ++c) {
        columns.emplace_back();
        for (std::size_t k = 0; k < at_s_.size(); k += stride) columns.back().push_back(rows_[c][k]);
    }
    return {columns, weight};
}

// A delay that fits, with the squares that it leaves by block.
struct Alignment::Candidate {
    SimulationLag lag;
    double clock = 0.0, clock_deviation = 0.0;
    std::vector<double> squares;
    bool converged = false;
};

// Columns that are fitted at a delay: first those whose factors tell it. A lag of first order differs from a
// delay by the second derivative, which for a single sine is the value itself.
Places Alignment::fitted(const BlockProducts& products, const Question& of, bool with_clock) const {
    if (of.is_simulated) return Places{slope} + of.nuisance;
    Places first{simulated, slope};
    if (with_clock) first.push_back(drift);
    const VectorXd second = products.column(bend);
    if (products.squares(second, Places{simulated} + of.nuisance, false) >=
        1e-2 * products.product(second, second))
        first.push_back(bend);
    return std::move(first) + of.nuisance;
}

Alignment::Candidate Alignment::refined(double delay_s, bool with_clock, const Question& of) const {
    Candidate found;
    found.lag.delay_s = delay_s;
    double clock_error = 0.0;
    const double step_s = 0.25 * smoothing_s_;
    for (int iteration = 0; iteration < 30 && !found.converged && std::abs(delay_s) <= range_s_;
         ++iteration) {
        const BlockProducts products = this->products(delay_s, clock_error);
        const VectorXd factors =
            products.values(products.column(of.target()), fitted(products, of, with_clock));
        // Where samples are joined by lines the curvature has steps, between which it may alternate.
        const double part = iteration < 8 ? 1.0 : 0.5;
        const double change_s = part * std::clamp(of.delay_of(factors), -step_s, step_s);
        if (!std::isfinite(change_s)) break;
        delay_s += change_s;
        if (with_clock) clock_error -= part * factors[2] / factors[0];
        found.converged = std::abs(change_s) < (iteration < 20 ? 1e-9 : 1e-6);
    }
    if (found.converged) found.lag.delay_s = delay_s;
    if (found.converged && with_clock) found.lag.clock_error = clock_error;
    measure(found, with_clock, of);
    return found;
}

void Alignment::measure(Candidate& found, bool with_clock, const Question& of) const {
    SimulationLag& lag = found.lag;
    const BlockProducts products = this->products(lag.delay_s, lag.clock_error.value_or(0.0));
    const VectorXd target = products.column(of.target());
    const Places by = fitted(products, of, with_clock), with_drift = Places{drift, third} + by;
    // A motion whose frequency changes in the course of the log looks like a clock, unless amplitude and
    // delay may depend on the frequency.
    const auto clock_of = [](const VectorXd& factors) { return -factors[0] / factors[2]; };
    const VectorXd factors = products.values(target, by);
    lag.scale = of.is_simulated ? 1.0 : factors[0];
    found.clock = clock_of(products.values(target, with_drift));
    double delays = 0.0, clocks = 0.0;
    for (std::size_t b = 0; b < BlockProducts::blocks; ++b) {
        const double off_s = of.delay_of(products.values(target, by, b)) - of.delay_of(factors);
        const double off = clock_of(products.values(target, with_drift, b)) - found.clock;
        delays += off_s * off_s;
        clocks += off * off;
    }
    // The delete-a-block jackknife (Efron and Tibshirani 1993, chapter 11).
    found.clock_deviation = std::sqrt(clocks * freedom / (freedom + 1.0));
    found.squares = products.left(target, by, false);
    // No simulation agrees better than to a thousandth: below, samples joined by lines decide.
    const double floor = 1e-6 * products.product(target, target) / (freedom + 1.0);
    for (double& each : found.squares) each = std::max(each, floor);
    Places rest = by;
    std::erase(rest, Index{slope});
    const double information = lag.scale * lag.scale * products.squares(products.column(slope), rest, false);
    const double misfit_s = information > 0.0 ? std::sqrt(sum_of(found.squares) / information) : 0.0;
    const double half_s =
        portable::hypot(student_95(freedom) * std::sqrt(delays * freedom / (freedom + 1.0)),
                        rows_.size() > 2 && !of.is_simulated ? misfit_share * misfit_s : 0.0);
    lag.delay_95_s = {lag.delay_s - half_s, lag.delay_s + half_s};
    lag.left = products.squares(target, by);
    const auto share = [&](const Places& explained_by, bool held_out) {
        return 1.0 - products.squares(target, explained_by, held_out) /
                         products.squares(target, of.alone(), held_out);
    };
    lag.explained = share(by, true);
    lag.correlation = std::copysign(std::sqrt(std::max(share(of.at_a_delay(), false), 0.0)), lag.scale);
}

// Delays at which the residual has a local minimum, least residual first.
std::vector<double> Alignment::minima_s(const Question& of) const {
    const std::size_t stride = 1 + at_s_.size() / 4000;  // rows enough to find a minimum
    const double step_s = 0.25 * smoothing_s_;
    std::vector<double> left, minima;
    std::vector<std::pair<double, double>> found;
    const auto most = static_cast<int>(range_s_ / step_s);
    for (int d = -most; d <= most; ++d) {
        const BlockProducts products = this->products(step_s * d, 0.0, stride);
        const VectorXd target = products.column(of.target());
        left.push_back(products.squares(target, of.at_a_delay(), false) /
                       products.squares(target, of.alone(), false));
    }
    for (std::size_t k = 0; k < left.size(); ++k)
        if ((k == 0 || left[k] <= left[k - 1]) && (k + 1 == left.size() || left[k] < left[k + 1]))
            found.emplace_back(left[k], step_s * (static_cast<double>(k) - most));
    std::ranges::sort(found);
    for (const auto& [squares, delay_s] : found) minima.push_back(delay_s);
    return minima;
}

SimulationLag Alignment::lag(const Question& of) const {
    if (at_s_.size() < BlockProducts::blocks * 4 + 2 * (rows_.size() + 3)) return {};  // than values to fit
    std::vector<Candidate> found;
    const std::vector<double> starts_s = minima_s(of);
    for (std::size_t k = 0; k < starts_s.size() && found.size() < 4; ++k) {
        Candidate one = refined(starts_s[k], false, of);
        const bool known = std::ranges::any_of(found, [&](const Candidate& other) {
            return std::abs(other.lag.delay_s - one.lag.delay_s) < 0.25 * smoothing_s_;
        });
        if (one.converged && !known) found.push_back(std::move(one));
    }
    if (found.empty()) found.push_back(refined(starts_s.empty() ? 0.0 : starts_s.front(), false, of));
    const auto squares = [](const Candidate& one) { return sum_of(one.squares); };
    const Candidate least = *std::ranges::min_element(found, {}, squares);
    // Others that leave as little stay: a paired t test of the logarithms, in which a block with large
    // residuals counts no more than others.
    std::erase_if(found, [&](const Candidate& one) {
        if (one.lag.delay_s == least.lag.delay_s ||
            (least.lag.scale < 0.0 && one.lag.scale > 0.0 && squares(one) < reversed_ratio * squares(least)))
            return false;
        double mean = 0.0, square = 0.0;
        for (std::size_t b = 0; b < one.squares.size(); ++b) {
            const double ratio = portable::log(one.squares[b] / least.squares[b]);
            mean += ratio / (freedom + 1.0);
            square += ratio * ratio / (freedom + 1.0);
        }
        return mean > student_95(freedom) * std::sqrt((square - mean * mean) / freedom);
    });
    // Of those the one without a reversal of sign and with the least delay.
    Candidate best = *std::ranges::min_element(found, {}, [](const Candidate& one) {
        return std::pair(one.lag.scale < 0.0, std::abs(one.lag.delay_s));
    });
    bool is_one = best.converged && found.size() == 1;
    if (is_one && !of.is_simulated && std::abs(best.clock) > clock_quantile * best.clock_deviation) {
        Candidate with = refined(best.lag.delay_s, true, of);
        if (with.converged) best = std::move(with);
    }
    SimulationLag& lag = best.lag;
    lag.is_compared = true;
    lag.identifiable = is_one && lag.delay_95_s.high - lag.delay_95_s.low <= 2.0 * smoothing_s_ &&
                       lag.explained >= (of.is_simulated || lag.scale < 0.0 ? least_of_all : least_share);
    return lag;
}

}  // namespace ripplenotch
