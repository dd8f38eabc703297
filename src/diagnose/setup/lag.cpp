// SPDX-License-Identifier: MIT
#include "diagnose/setup/lag.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "diagnose/setup/setup.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/portable_math.hpp"
#include "ripplenotch/diagnose/setup.hpp"

namespace ripplenotch {

namespace {

// The usual step of a series of times: the median.
double usual_step_s(std::span<const double> time_s) {
    std::vector<double> steps;
    for (std::size_t k = 1; k < time_s.size(); ++k) steps.push_back(time_s[k] - time_s[k - 1]);
    return median_in(steps);
}

}  // namespace

SmoothedSeries::SmoothedSeries(std::span<const double> time_s, std::span<const double> value,
                               double half_width_s)
    : time_s_(time_s), value_(value.begin(), value.end()), width_s_(half_width_s) {
    // About its mean: the second integral grows with the square of time.
    mean_ = std::accumulate(value_.begin(), value_.end(), 0.0) / static_cast<double>(value_.size());
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

double SmoothedSeries::integral(Integral kind, double at_s) const {
    const auto next = std::upper_bound(time_s_.begin(), time_s_.end(), at_s) - time_s_.begin();
    const auto k =
        std::min(static_cast<std::size_t>(std::max<std::ptrdiff_t>(next - 1, 0)), value_.size() - 2);
    const double t = at_s - time_s_[k];
    const double slope = (value_[k + 1] - value_[k]) / (time_s_[k + 1] - time_s_[k]);
    switch (kind) {
        case Integral::none:
            return value_[k] + t * slope;
        case Integral::once:
            return once_[k] + t * (value_[k] + 0.5 * t * slope);
        default:
            return twice_[k] + t * (once_[k] + t * (0.5 * value_[k] + t * slope / 6.0));
    }
}

double SmoothedSeries::second_difference(Integral kind, double at_s) const {
    return (integral(kind, at_s + width_s_) - 2.0 * integral(kind, at_s) + integral(kind, at_s - width_s_)) /
           (width_s_ * width_s_);
}

double SmoothedSeries::mean(double at_s) const { return mean_ + second_difference(Integral::twice, at_s); }

double SmoothedSeries::slope(double at_s) const { return second_difference(Integral::once, at_s); }

double SmoothedSeries::curvature(double at_s) const { return second_difference(Integral::none, at_s); }

namespace {

/// A smoothed series, or its slope in time.
struct SmoothedSignal {
    const SmoothedSeries& series;
    bool is_slope = false;

    [[nodiscard]] double value(double at_s) const {
        return is_slope ? series.slope(at_s) : series.mean(at_s);
    }
    [[nodiscard]] double derivative(double at_s) const {
        return is_slope ? series.curvature(at_s) : series.slope(at_s);
    }
};

struct ShiftProblem {
    std::vector<double> at_s;                    ///< ascending; of the log
    std::vector<double> target;                  ///< the log's values at these times
    std::vector<std::vector<double>> nuisances;  ///< at these times
    SmoothedSignal simulated;
    double range_s = 1.0, smoothing_s = 0.05;
    double misfit_share = 0.0;  ///< share of SimulationLag::misfit_s that the interval includes
};

struct ShiftFit {
    SimulationLag lag;
    double held_out_squares = 0.0;  ///< squares of held-out blocks
};

using ShiftColumns = std::vector<std::vector<double>>;

double product_of(const std::vector<double>& a, const std::vector<double>& b) {
    return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
}

// The residual of columns after projection on others, by orthonormal combinations of these (modified
// Gram-Schmidt).
class Complement {
  public:
    explicit Complement(const ShiftColumns& columns) {
        for (const auto& column : columns) add(column);
    }
    void add(std::vector<double> column) {
        const double before = product_of(column, column);
        remove_from(column);
        remove_from(column);  // twice is enough (Giraud, Langou and Rozloznik 2005)
        const double after = product_of(column, column);
        if (!(after > 1e-12 * before)) return;
        for (double& each : column) each /= std::sqrt(after);
        basis_.push_back(std::move(column));
    }
    void remove_from(std::vector<double>& values) const {
        for (const auto& direction : basis_) {
            const double size = product_of(direction, values);
            for (std::size_t k = 0; k < values.size(); ++k) values[k] -= size * direction[k];
        }
    }

  private:
    ShiftColumns basis_;
};

// Time of a row of the log on the clock of the simulation.
struct Shift {
    double delay_s = 0.0, clock_error = 0.0, middle_s = 0.0;
    [[nodiscard]] double operator()(double at_s) const {
        return at_s - delay_s - clock_error * (at_s - middle_s);
    }
};

struct Refined {
    Shift shift;
    double scale = 0.0, correlation = 0.0, squares = 0.0;
    std::vector<std::size_t> block;  // block of each row
    std::vector<double> block_squares, held_out;
    double delay_error_s = 0.0, scale_error = 0.0;
    double clock = 0.0, clock_error = 0.0;  // and its standard error
    double information = 0.0;               // squares of the derivative that nothing else explains
    bool converged = false;
};

class ShiftSearch {
  public:
    ShiftSearch(const ShiftProblem& problem, const AlignmentOptions& options)
        : problem_(problem), options_(options), step_s_(0.25 * problem.smoothing_s) {
        for (double d = 0.0; d <= problem.range_s; d += step_s_) {
            if (d > 0.0) delays_s_.insert(delays_s_.begin(), -d);
            delays_s_.push_back(d);
        }
        const auto covered = [&](double at_s) {
            return std::all_of(delays_s_.begin(), delays_s_.end(),
                               [&](double d) { return problem.simulated.series.covers(at_s - d); }) &&
                   problem.simulated.series.covers(at_s - problem.range_s - around_s()) &&
                   problem.simulated.series.covers(at_s + problem.range_s + around_s());
        };
        nuisances_.resize(problem.nuisances.size());
        for (std::size_t k = 0; k < problem.at_s.size(); ++k) {
            if (!covered(problem.at_s[k])) continue;
            at_s_.push_back(problem.at_s[k]);
            target_.push_back(problem.target[k]);
            for (std::size_t c = 0; c < nuisances_.size(); ++c)
                nuisances_[c].push_back(problem.nuisances[c][k]);
        }
    }

    [[nodiscard]] std::size_t rows() const { return at_s_.size(); }
    [[nodiscard]] double step_s() const { return step_s_; }

    // Delays at which the residual has a local minimum, least residual first.
    [[nodiscard]] std::vector<double> minima_s() const {
        const std::size_t stride = 1 + rows() / 20000;  // rows enough to find a minimum
        ShiftColumns thinned;
        for (const auto& column : nuisances_) thinned.push_back(every(column, stride));
        const Complement complement(thinned);
        const std::vector<double> at_s = every(at_s_, stride);
        std::vector<double> target = every(target_, stride);
        complement.remove_from(target);
        std::vector<double> explained;
        for (const double d : delays_s_) {
            std::vector<double> column;
            for (const double t : at_s) column.push_back(problem_.simulated.value(t - d));
            complement.remove_from(column);
            const double squares = product_of(column, column), with = product_of(column, target);
            explained.push_back(squares > 0.0 ? with * with / squares : 0.0);
        }
        std::vector<std::pair<double, double>> found;
        for (std::size_t k = 0; k < explained.size(); ++k) {
            const bool above_before = k == 0 || explained[k] >= explained[k - 1];
            const bool above_next = k + 1 == explained.size() || explained[k] > explained[k + 1];
            if (above_before && above_next) found.emplace_back(-explained[k], delays_s_[k]);
        }
        std::sort(found.begin(), found.end());
        std::vector<double> minima_s;
        for (const auto& [explained_less, d] : found) minima_s.push_back(d);
        return minima_s;
    }

    // By Gauss-Newton steps; where they leave the range, as at the start.
    [[nodiscard]] Refined refined(Shift start, bool with_clock) const {
        const Complement complement(nuisances_);
        start.middle_s = 0.5 * (at_s_.front() + at_s_.back());
        Shift shift = start;
        Refined found;
        for (int iteration = 0; iteration < 30 && !found.converged; ++iteration) {
            const ShiftColumns columns = with_shift(complement, shift, with_clock);
            const std::vector<std::size_t> one(rows(), 0);
            const auto values = BlockedSquares(columns, target_, one).values();
            // With samples joined by lines the curvature has steps, between which the iteration may
            // alternate.
            const double part = iteration < 8 ? 1.0 : 0.5;
            const double change_s = part * std::clamp(values[0], -step_s_, step_s_);
            shift.delay_s += change_s;
            if (with_clock) shift.clock_error += part * values[1];
            found.converged = std::abs(change_s) < (iteration < 20 ? 1e-9 : 1e-6);
            if (std::abs(shift.delay_s) > problem_.range_s) break;
        }
        found.shift = found.converged ? shift : start;
        measure(complement, with_clock, found);
        return found;
    }

    // The drift of the delay with its error, where amplitude and delay may depend on the frequency: a motion
    // whose frequency changes in the course of the log looks like a clock otherwise.
    void measure_clock(Refined& found) const {
        const Complement complement(nuisances_);
        ShiftColumns columns = with_shift(complement, found.shift, true);
        std::vector<double> third;
        for (const double t : at_s_) {
            const double at = found.shift(t);
            third.push_back(problem_.simulated.derivative(at + around_s()) -
                            2.0 * problem_.simulated.derivative(at) +
                            problem_.simulated.derivative(at - around_s()));
        }
        columns.push_back(std::move(third));
        const BlockedSquares fit(columns, target_, found.block);
        found.clock = fit.values()[1];
        found.clock_error = fit.jackknife_error(1);
    }

    // Squares that nuisance parameters alone leave of blocks held out.
    [[nodiscard]] double held_out_without(const Refined& found) const {
        const auto squares = BlockedSquares(nuisances_, target_, found.block).held_out();
        return std::accumulate(squares.begin(), squares.end(), 0.0);
    }

  private:
    static std::vector<double> every(const std::vector<double>& values, std::size_t stride) {
        std::vector<double> thinned;
        for (std::size_t k = 0; k < values.size(); k += stride) thinned.push_back(values[k]);
        return thinned;
    }

    // To either side, over which derivatives of the smoothed simulation are differences.
    [[nodiscard]] double around_s() const { return 0.5 * problem_.smoothing_s; }

    // Columns of the delay, of the clock if requested, of the scale, and of the second derivative, by which a
    // lag of first order differs from a delay; then the nuisances.
    [[nodiscard]] ShiftColumns with_shift(const Complement& complement, const Shift& shift,
                                          bool with_clock) const {
        std::vector<double> value, slope, drift, second;
        for (const double t : at_s_) {
            value.push_back(problem_.simulated.value(shift(t)));
            slope.push_back(-problem_.simulated.derivative(shift(t)));
            second.push_back(problem_.simulated.derivative(shift(t) + around_s()) -
                             problem_.simulated.derivative(shift(t) - around_s()));
        }
        std::vector<double> own = value;
        complement.remove_from(own);
        const double squares = product_of(own, own);
        const double scale = squares > 0.0 ? product_of(own, target_) / squares : 0.0;
        for (std::size_t k = 0; k < slope.size(); ++k) {
            slope[k] *= scale;
            drift.push_back(slope[k] * (at_s_[k] - shift.middle_s));
        }
        // For a single sine the second derivative is a multiple of the value, and no scale would be
        // identifiable.
        const double before = product_of(second, second);
        std::vector<double> alone = second;
        Complement with_value = complement;
        with_value.add(value);
        with_value.remove_from(alone);
        if (product_of(alone, alone) < 1e-2 * before) second.assign(second.size(), 0.0);
        ShiftColumns columns{std::move(slope)};
        if (with_clock) columns.push_back(std::move(drift));
        columns.push_back(std::move(value));
        columns.push_back(std::move(second));
        columns.insert(columns.end(), nuisances_.begin(), nuisances_.end());
        return columns;
    }

    void measure(const Complement& nuisances, bool with_clock, Refined& found) const {
        const ShiftColumns columns = with_shift(nuisances, found.shift, with_clock);
        const std::size_t scale_at = with_clock ? 2 : 1;
        std::vector<double> value = columns[scale_at], target = target_, information = columns.front();
        Complement others = nuisances;
        nuisances.remove_from(value);
        nuisances.remove_from(target);
        const double squares = product_of(value, value) * product_of(target, target);
        found.correlation = squares > 0.0 ? product_of(value, target) / std::sqrt(squares) : 0.0;
        others.add(columns[scale_at]);
        others.add(columns[scale_at + 1]);
        others.remove_from(information);
        for (double& each : information) each *= each;
        found.information = std::accumulate(information.begin(), information.end(), 0.0);
        found.block = equal_blocks(information, options_.blocks);
        const BlockedSquares fit(columns, target_, found.block);
        found.scale = fit.values()[static_cast<Eigen::Index>(scale_at)];
        found.scale_error = fit.jackknife_error(scale_at);
        found.delay_error_s = fit.jackknife_error(0);
        if (with_clock) found.clock_error = fit.jackknife_error(1);
        // No simulation agrees better than to a thousandth: below, samples joined by lines decide.
        const double floor = 1e-6 * product_of(target, target) / static_cast<double>(options_.blocks);
        found.block_squares = fit.left();
        for (double& each : found.block_squares) each = std::max(each, floor);
        found.held_out = fit.held_out();
        found.squares = std::accumulate(found.block_squares.begin(), found.block_squares.end(), 0.0);
    }

    const ShiftProblem& problem_;
    const AlignmentOptions& options_;
    double step_s_;
    std::vector<double> delays_s_, at_s_, target_;
    ShiftColumns nuisances_;
};

// Whether the residual of one fit exceeds that of another by more than the scatter between blocks: a paired t
// test of the logarithms, in which a block with large residuals counts no more than any other.
bool clearly_worse(const std::vector<double>& squares, const std::vector<double>& best, double quantile) {
    const auto count = static_cast<double>(best.size());
    std::vector<double> ratios;
    for (std::size_t b = 0; b < best.size(); ++b)
        ratios.push_back(portable::log(std::max(squares[b], 1e-300) / std::max(best[b], 1e-300)));
    const double mean = std::accumulate(ratios.begin(), ratios.end(), 0.0) / count;
    double spread = 0.0;
    for (const double ratio : ratios) spread += (ratio - mean) * (ratio - mean);
    return mean > quantile * std::sqrt(spread / (count * (count - 1.0)));
}

Interval interval_about(double value, double half_width) { return {value - half_width, value + half_width}; }

// Why a lag with such an interval is not identifiable.
std::string too_wide(const SimulationLag& lag) {
    return fmt::format(
        "the 95 % interval of the delay, {:.3g} to {:.3g} s, is wider than the window of {:.2g} s",
        lag.delay_95_s.low, lag.delay_95_s.high, 2.0 * lag.smoothing_s);
}

std::string reason_against(const SimulationLag& lag, const ShiftProblem& problem,
                           const AlignmentOptions& options) {
    const double least = lag.correlation > 0.0 ? options.least_explained : options.least_reversed;
    if (!(lag.explained >= least))
        return fmt::format("the simulation explains {:.0f} % of the variance of blocks held out",
                           100.0 * std::max(lag.explained, 0.0));
    if (!lag.alternatives_s.empty())
        return fmt::format("a delay of {:.3g} s fits as well as {:.3g} s: the motion is periodic",
                           lag.alternatives_s.front(), lag.delay_s);
    if (lag.delay_95_s.high - lag.delay_95_s.low > 2.0 * problem.smoothing_s) return too_wide(lag);
    return {};
}

// The best of the minima, of those that leave as little the one without a reversal of sign and with the least
// delay; the others as alternatives.
Refined best_of(const ShiftSearch& search, const AlignmentOptions& options,
                std::vector<double>& alternatives_s) {
    std::vector<Refined> found;
    const std::vector<double> minima_s = search.minima_s();
    for (const double d : minima_s) {
        if (found.size() == 4) break;  // the best, and enough to show that there is more than one
        Refined one = search.refined({d, 0.0, 0.0}, false);
        const bool known = std::any_of(found.begin(), found.end(), [&](const Refined& other) {
            return std::abs(other.shift.delay_s - one.shift.delay_s) < search.step_s();
        });
        if (one.converged && !known) found.push_back(std::move(one));
    }
    if (found.empty()) return search.refined({minima_s.front(), 0.0, 0.0}, false);
    const Refined least = *std::min_element(
        found.begin(), found.end(), [](const auto& a, const auto& b) { return a.squares < b.squares; });
    std::erase_if(found, [&](const Refined& one) {
        if (one.block_squares == least.block_squares) return false;
        const bool may_be_reversed = least.correlation < 0.0 && one.correlation > 0.0 &&
                                     one.squares < options.reversed_ratio * least.squares;
        return !may_be_reversed && clearly_worse(one.block_squares, least.block_squares, options.quantile);
    });
    std::sort(found.begin(), found.end(), [](const Refined& a, const Refined& b) {
        return std::pair(a.correlation < 0.0, std::abs(a.shift.delay_s)) <
               std::pair(b.correlation < 0.0, std::abs(b.shift.delay_s));
    });
    for (std::size_t k = 1; k < found.size(); ++k) alternatives_s.push_back(found[k].shift.delay_s);
    return found.front();
}

}  // namespace

std::vector<double> window_times(const std::vector<const SmoothedSeries*>& series, double smoothing_s) {
    std::vector<double> times_s;
    const double from_s = series.front()->first_s() + smoothing_s,
                 to_s = series.front()->last_s() - smoothing_s;
    for (double k = 0.0; from_s + 0.5 * k * smoothing_s <= to_s; k += 1.0) {
        const double at_s = from_s + 0.5 * k * smoothing_s;
        if (std::all_of(series.begin(), series.end(), [&](const auto* one) { return one->covers(at_s); }))
            times_s.push_back(at_s);
    }
    return times_s;
}

double search_range_s(std::span<const double> time_s, const AlignmentOptions& options) {
    if (options.range) return options.range->value();
    return std::min(1.0, 0.1 * (time_s.back() - time_s.front()));
}

namespace {

// The lag and what else `SimulationLag` holds, but for the agreement of motions.
ShiftFit fit_shift(const ShiftProblem& problem, const AlignmentOptions& options) {
    ShiftFit result;
    SimulationLag& lag = result.lag;
    lag.smoothing_s = problem.smoothing_s;
    const ShiftSearch search(problem, options);
    // A block needs more rows than there are values to fit.
    if (search.rows() < options.blocks * 4 + 2 * (problem.nuisances.size() + 4)) {
        lag.reason = "log and simulation have too few seconds in common";
        return result;
    }
    Refined best = best_of(search, options, lag.alternatives_s);
    if (best.converged) {
        search.measure_clock(best);
        lag.clock_error_95 = interval_about(best.clock, options.quantile * best.clock_error);
    }
    if (best.converged && std::abs(best.clock) > options.clock_quantile * best.clock_error &&
        lag.alternatives_s.empty()) {
        const Refined with = search.refined({best.shift.delay_s, best.clock, 0.0}, true);
        if (with.converged) {
            lag.clock_error = with.shift.clock_error;
            lag.clock_error_95 = interval_about(with.shift.clock_error, options.quantile * with.clock_error);
            best = with;
        }
    }
    lag.middle_s = best.shift.middle_s;
    lag.delay_s = best.shift.delay_s;
    lag.misfit_s = best.information > 0.0 ? std::sqrt(best.squares / best.information) : 0.0;
    lag.delay_95_s = interval_about(lag.delay_s, portable::hypot(options.quantile * best.delay_error_s,
                                                                 problem.misfit_share * lag.misfit_s));
    lag.scale = best.scale;
    lag.scale_95 = interval_about(lag.scale, options.quantile * best.scale_error);
    lag.correlation = best.correlation;
    lag.blocks = best.held_out.size();
    result.held_out_squares = std::accumulate(best.held_out.begin(), best.held_out.end(), 0.0);
    const double without = search.held_out_without(best);
    lag.explained = without > 0.0 ? 1.0 - result.held_out_squares / without : 0.0;
    lag.reason = reason_against(lag, problem, options);
    if (!best.converged && lag.reason.empty())
        lag.reason = "no delay within the range of the search fits better than its limits";
    lag.identifiable = lag.reason.empty();
    return result;
}

bool is_constant(std::span<const double> values) {
    const auto [low, high] = std::minmax_element(values.begin(), values.end());
    return !(*high > *low);
}

// Two fits whose scales differ by more are fits of different effects: together with a weight and an inertia
// of the joint, the remainder of a simulation that holds nothing else may have any scale.
bool has_like_scale(const SimulationLag& a, const SimulationLag& b) {
    return a.scale * b.scale > 0.0 && std::abs(portable::log(a.scale / b.scale)) <= portable::log(1.5);
}

// The first fit that is identifiable, unless one with more nuisance parameters halves the squares of blocks
// held out at about its scale. The interval reaches to the delays of the others that leave about as little
// and disagree.
SimulationLag chosen_lag(const std::vector<ShiftFit>& fits) {
    const ShiftFit* chosen = &fits.front();
    for (const ShiftFit& fit : fits) {
        if (!fit.lag.identifiable) continue;
        const bool halves = fit.held_out_squares < 0.5 * chosen->held_out_squares;
        if (!chosen->lag.identifiable || (halves && has_like_scale(fit.lag, chosen->lag))) chosen = &fit;
    }
    SimulationLag lag = chosen->lag;
    for (const ShiftFit& fit : fits) {
        const Interval& other = fit.lag.delay_95_s;
        const bool agrees = other.low <= lag.delay_s && lag.delay_s <= other.high;
        if (!fit.lag.identifiable || agrees || fit.held_out_squares > 2.0 * chosen->held_out_squares)
            continue;
        if (!has_like_scale(fit.lag, chosen->lag)) continue;
        lag.delay_95_s.low = std::min(lag.delay_95_s.low, fit.lag.delay_s);
        lag.delay_95_s.high = std::max(lag.delay_95_s.high, fit.lag.delay_s);
    }
    if (lag.identifiable && lag.delay_95_s.high - lag.delay_95_s.low > 2.0 * lag.smoothing_s) {
        lag.identifiable = false;
        lag.reason = too_wide(lag);
    }
    return lag;
}

}  // namespace

SimulationLag lag_by_torque(const TraceView& log, const SimulatedMotion& simulation,
                            std::optional<GearRatio> gear_ratio, const AlignmentOptions& options) {
    SimulationLag none;
    if (log.size() < 8 || simulation.torque_nm.size() < 8) {
        none.reason = "log or simulation has too few torques";
        return none;
    }
    if (is_constant(log.torque_nm) || is_constant(simulation.torque_nm)) {
        none.reason = "the torque of log or simulation is constant";
        return none;
    }
    const double smoothing_s = std::max(
        {options.smoothing.value(), 2.0 * usual_step_s(log.time_s), 2.0 * usual_step_s(simulation.time_s)});
    const SmoothedSeries left(log.time_s, log.torque_nm, smoothing_s),
        right(simulation.time_s, simulation.torque_nm, smoothing_s);
    ShiftProblem problem{
        {}, {}, {}, {right, false}, search_range_s(log.time_s, options), smoothing_s, options.misfit_share};
    problem.at_s = window_times({&left}, smoothing_s);
    for (const double at_s : problem.at_s) problem.target.push_back(left.mean(at_s));
    const NuisanceColumns columns(log, gear_ratio, options, {problem.at_s, smoothing_s});
    const bool has_weight = columns.has_position(), has_load = columns.has_velocity();
    std::vector<ShiftFit> fits;
    const auto try_with = [&](NuisanceChoice choice) {
        choice.friction = choice.ripple = true;
        problem.nuisances = columns.of(choice);
        fits.push_back(fit_shift(problem, options));
    };
    try_with({});
    if (has_load) try_with({.inertia = true});
    if (has_weight) try_with({.inertia = true, .gravity = true});
    if (has_load) try_with({.inertia = true, .load = true});
    if (has_load && has_weight) try_with({.inertia = true, .gravity = true, .load = true});
    return chosen_lag(fits);
}

namespace {

double travel_of(std::span<const double> values) {
    const auto [low, high] = std::minmax_element(values.begin(), values.end());
    return *high - *low;
}

// One motion: the series that its velocity is taken from.
struct MotionSeries {
    std::span<const double> value;
    bool is_position = false;
};

// The same series of both, if there is one: a velocity of the log may have passed a filter that its position
// has not.
std::pair<MotionSeries, MotionSeries> chosen_series(const TraceView& log, const SimulatedMotion& simulation) {
    const bool both_velocities = !log.velocity_deg_s.empty() && !simulation.velocity_deg_s.empty();
    const bool log_position = log.has_position() && (!simulation.position_deg.empty() || !both_velocities);
    const bool simulated_position =
        !simulation.position_deg.empty() && (log.has_position() || !both_velocities);
    return {log_position ? MotionSeries{log.position_deg, true} : MotionSeries{log.velocity_deg_s, false},
            simulated_position ? MotionSeries{simulation.position_deg, true}
                               : MotionSeries{simulation.velocity_deg_s, false}};
}

SeriesAgreement agreement_of(const SmoothedSeries& log, const SmoothedSeries& simulation,
                             const SimulationLag& lag) {
    SeriesAgreement agreement;
    std::vector<double> left, right;
    for (const double at_s : window_times({&log}, lag.smoothing_s)) {
        const double other_s = at_s - lag.delay_s - lag.clock_error.value_or(0.0) * (at_s - lag.middle_s);
        if (!simulation.covers(other_s)) continue;
        left.push_back(log.mean(at_s));
        right.push_back(simulation.mean(other_s));
    }
    if (left.empty()) return agreement;
    const auto count = static_cast<double>(left.size());
    double mean_left = 0.0, mean_right = 0.0, squares_left = 0.0, squares_right = 0.0, products = 0.0,
           differences = 0.0;
    for (std::size_t k = 0; k < left.size(); ++k) {
        mean_left += left[k] / count;
        mean_right += right[k] / count;
        differences += (left[k] - right[k]) * (left[k] - right[k]) / count;
    }
    for (std::size_t k = 0; k < left.size(); ++k) {
        squares_left += (left[k] - mean_left) * (left[k] - mean_left);
        squares_right += (right[k] - mean_right) * (right[k] - mean_right);
        products += (left[k] - mean_left) * (right[k] - mean_right);
    }
    const double both = std::sqrt(squares_left * squares_right);
    agreement.correlation = both > 0.0 ? products / both : 0.0;
    agreement.scale = squares_right > 0.0 ? products / squares_right : 0.0;
    agreement.offset = mean_left - agreement.scale * mean_right;
    agreement.rms_difference = std::sqrt(differences);
    agreement.travel = travel_of(left);
    return agreement;
}

}  // namespace

SimulationLag lag_by_motion(const TraceView& log, const SimulatedMotion& simulation,
                            const AlignmentOptions& options) {
    SimulationLag none;
    if (!simulation.has_motion() || (!log.has_position() && log.velocity_deg_s.empty())) {
        none.reason = "log or simulation has neither position nor velocity";
        return none;
    }
    if (std::min(log.time_s.size(), simulation.time_s.size()) < 8) {
        none.reason = "log or simulation has too few samples";
        return none;
    }
    const auto [measured, simulated] = chosen_series(log, simulation);
    if (!(travel_of(measured.value) > 0.0) || !(travel_of(simulated.value) > 0.0)) {
        none.reason = "the joint does not move in the log or in the simulation";
        return none;
    }
    const double smoothing_s = std::max(
        {options.smoothing.value(), 2.0 * usual_step_s(log.time_s), 2.0 * usual_step_s(simulation.time_s)});
    const SmoothedSeries left(log.time_s, measured.value, smoothing_s),
        right(simulation.time_s, simulated.value, smoothing_s);
    ShiftProblem problem{{}, {}, {}, {right, simulated.is_position}, 0.0, smoothing_s};
    problem.range_s = search_range_s(log.time_s, options);
    problem.at_s = window_times({&left}, smoothing_s);
    const SmoothedSignal velocity{left, measured.is_position};
    for (const double at_s : problem.at_s) problem.target.push_back(velocity.value(at_s));
    problem.nuisances = {std::vector<double>(problem.at_s.size(), 1.0)};
    SimulationLag lag = fit_shift(problem, options).lag;
    if (log.has_position() && !simulation.position_deg.empty())
        lag.position = agreement_of({log.time_s, log.position_deg, smoothing_s},
                                    {simulation.time_s, simulation.position_deg, smoothing_s}, lag);
    if (!log.velocity_deg_s.empty() && !simulation.velocity_deg_s.empty())
        lag.velocity = agreement_of({log.time_s, log.velocity_deg_s, smoothing_s},
                                    {simulation.time_s, simulation.velocity_deg_s, smoothing_s}, lag);
    return lag;
}

}  // namespace ripplenotch
