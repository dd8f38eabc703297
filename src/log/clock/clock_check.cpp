// SPDX-License-Identifier: MIT
#include "log/clock/clock_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/vectors/lanes.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/portable_math.hpp"
#include "ripplenotch/log/clock.hpp"

namespace ripplenotch {

namespace {

struct SumUp {
    template <class Lanes>
    RIPPLENOTCH_INLINED static StepSums run(std::span<const double> time_s, double usual_s) {
        const std::size_t steps = time_s.size() - 1, even = steps - steps % lane_count;
        const double first = time_s[1] - time_s[0];
        Lanes before, now, usual, shortest, longest, squares;
        fill(usual, usual_s);
        fill(shortest, first);
        fill(longest, first);
        fill(squares, 0.0);
        for (std::size_t k = 0; k < even; k += lane_count) {
            load(before, time_s.data() + k);
            load(now, time_s.data() + k + 1);
            const Lanes step = now - before, off = step - usual;
            squares += off * off;
            lower(shortest, step);
            raise(longest, step);
        }
        StepSums sums{first, first, sum(squares)};
        double least[lane_count], most[lane_count];
        store(least, shortest);
        store(most, longest);
        for (std::size_t i = 0; i < lane_count; ++i) {
            sums.shortest_s = std::min(sums.shortest_s, least[i]);
            sums.longest_s = std::max(sums.longest_s, most[i]);
        }
        for (std::size_t k = even; k < steps; ++k) {
            const double step = time_s[k + 1] - time_s[k];
            sums.squares += (step - usual_s) * (step - usual_s);
            sums.shortest_s = std::min(sums.shortest_s, step);
            sums.longest_s = std::max(sums.longest_s, step);
        }
        return sums;
    }
};

constexpr double nominal_tolerance = 0.001;  // by hand
// Steps cluster at their median when so many are this near, and their mean stays nearer still: rounded stamps
// of another rate (4.4 ms as 4 or 5 ms) are near it too, but to one side.
constexpr double cluster_width = 0.25, cluster_share = 0.75, cluster_lean = 0.03;
// Stamps that keep within so many steps of even ones were never late: then rows over time is the rate.
constexpr double even_steps = 1.5;
constexpr double few_repeats = 0.01;  // by hand

double two_digits(double value) {
    const double scale = portable::pow(10.0, std::floor(portable::log10(value)) - 1.0);
    // Dividing by a whole power of ten is exact where multiplying by a fraction is not: 0.001 s must give
    // 1000 Hz.
    return scale < 1.0 ? std::round(value / scale) / std::round(1.0 / scale)
                       : std::round(value / scale) * scale;
}

bool near(double a, double b) { return std::abs(a - b) <= nominal_tolerance * b; }

bool cluster(const std::vector<double>& advancing, double median_s) {
    double sum = 0.0;
    std::size_t count = 0;
    for (const double step : advancing) {
        if (std::abs(step - median_s) > cluster_width * median_s) continue;
        sum += step;
        ++count;
    }
    return static_cast<double>(count) >= cluster_share * static_cast<double>(advancing.size()) &&
           std::abs(sum / static_cast<double>(count) - median_s) <= cluster_lean * median_s;
}

/// The furthest that times get from even ones, gaps closed.
double furthest_from_even(std::span<const double> time_s, double mean_s, double limit_s) {
    double off = 0.0, furthest = 0.0;
    for (std::size_t k = 1; k < time_s.size(); ++k) {
        const double step = time_s[k] - time_s[k - 1];
        if (step > limit_s) continue;
        off += step - mean_s;
        furthest = std::max(furthest, std::abs(off));
    }
    return furthest;
}

std::string gaps_in_words(const ClockFacts& clock) {
    const Gap& longest = clock.longest_gap;
    return fmt::format("{} {} in the time, the longest of {:.4g} s after {:.9g} s; each starts a new run",
                       clock.gap_count, clock.gap_count == 1 ? "gap" : "gaps", longest.to_s - longest.from_s,
                       longest.from_s);
}

std::string changes_in_words(const ClockFacts& clock) {
    const RateChange& first = clock.rate_changes.front();
    const std::string change = fmt::format("from {:.6g} Hz to {:.6g} Hz after data row {} ({:.6g} s)",
                                           first.from.value(), first.to.value(), first.row + 1, first.time_s);
    const std::string changes =
        clock.rate_changes.size() == 1
            ? fmt::format("the clock changes {}", change)
            : fmt::format("the clock changes {} times, first {}", clock.rate_changes.size(), change);
    if (clock.rows_left_out == 0) return changes;
    return fmt::format(
        "{}; {} rows at another rate than {:.6g} Hz are left out and pass unfiltered: give each part a log "
        "of its own",
        changes, clock.rows_left_out, clock.nominal_rate.value());
}

constexpr std::size_t most_pieces_checked = 64;  // many enough for a median, long enough to average noise
constexpr std::size_t shortest_piece = 4;        // rows
constexpr double factor_agreement = 0.02;        // a factor within 2 % of 1, or of a named one, is that one
constexpr double widest_doubt = 0.05;            // a factor less certain than 5 % is not stated

using Piece = MotionPieces::Piece;

struct Fit {
    double factor = 0.0, lag_s = 0.0, doubt = 0.0;  // doubt: standard error of the factor
};

// Weighted least squares of position change on integrated velocity and change of velocity.
Fit weighted_fit(const std::vector<Piece>& pieces, const std::vector<double>& weights) {
    double xx = 0.0, xz = 0.0, zz = 0.0, xy = 0.0, zy = 0.0;
    for (std::size_t i = 0; i < pieces.size(); ++i) {
        const Piece& p = pieces[i];
        xx += weights[i] * p.integrated_velocity * p.integrated_velocity;
        xz += weights[i] * p.integrated_velocity * p.velocity_change;
        zz += weights[i] * p.velocity_change * p.velocity_change;
        xy += weights[i] * p.integrated_velocity * p.position_change;
        zy += weights[i] * p.velocity_change * p.position_change;
    }
    const double determinant = xx * zz - xz * xz;
    // A steady motion has no change of velocity to learn a lag from.
    const bool lag_known = determinant > 1e-6 * xx * zz;
    Fit fit;
    fit.factor = lag_known ? (xy * zz - zy * xz) / determinant : xy / xx;
    fit.lag_s = lag_known ? (zy * xx - xy * xz) / determinant : 0.0;
    double square = 0.0, weight = 0.0;
    for (std::size_t i = 0; i < pieces.size(); ++i) {
        const Piece& p = pieces[i];
        const double left =
            p.position_change - fit.factor * p.integrated_velocity - fit.lag_s * p.velocity_change;
        square += weights[i] * left * left;
        weight += weights[i];
    }
    const double freedom = std::max(1.0, weight - (lag_known ? 2.0 : 1.0));
    fit.doubt = std::sqrt(square / freedom * (lag_known ? zz / determinant : 1.0 / xx));
    return fit;
}

// The usual size of a piece's motion: the upper quartile, which neither rest nor a spike moves.
double usual_motion(const std::vector<Piece>& pieces) {
    std::vector<double> sizes;
    for (const Piece& piece : pieces) sizes.push_back(std::abs(piece.integrated_velocity));
    const auto quartile = sizes.begin() + static_cast<std::ptrdiff_t>(3 * sizes.size() / 4);
    std::nth_element(sizes.begin(), quartile, sizes.end());
    return *quartile;
}

// Tukey's biweight from a start that no spike moves, the median of the pieces' ratios: a spike in the
// velocity is far out in the regressor too, where an estimate that only bounds residuals would follow it (P.
// J. Rousseeuw, A. M. Leroy, Robust Regression and Outlier Detection, 1987). 4.685 deviations: 95 % efficient
// for normal errors.
Fit robust_fit(const std::vector<Piece>& pieces) {
    const double usual = usual_motion(pieces);
    std::vector<double> ratios;
    for (const Piece& p : pieces) {
        if (std::abs(p.integrated_velocity) > 0.3 * usual)
            ratios.push_back(p.position_change / p.integrated_velocity);
    }
    Fit fit;
    fit.doubt = std::numeric_limits<double>::infinity();
    if (ratios.empty()) return fit;
    fit.factor = median_of(std::move(ratios));
    std::vector<double> weights(pieces.size()), left(pieces.size());
    for (int round = 0; round < 50; ++round) {
        for (std::size_t i = 0; i < pieces.size(); ++i) {
            const Piece& p = pieces[i];
            left[i] = std::abs(p.position_change - fit.factor * p.integrated_velocity -
                               fit.lag_s * p.velocity_change);
        }
        // Where most pieces fit exactly, rounding alone is left as a deviation.
        const double deviation =
            std::max(deviations_of_median * median_of(left), 1e-9 * std::abs(fit.factor) * usual);
        for (std::size_t i = 0; i < pieces.size(); ++i) {
            const double far = left[i] / (4.685 * deviation);
            weights[i] = far < 1.0 ? (1.0 - far * far) * (1.0 - far * far) : 0.0;
        }
        const double before = fit.factor;
        fit = weighted_fit(pieces, weights);
        if (std::abs(fit.factor - before) <= 1e-12 * std::abs(before)) break;
    }
    return fit;
}

// Residuals of neighbouring pieces are alike, so the fit believes itself too much. Half the difference
// between the two halves of the motion, each of the same path, is an error estimate that does not.
double difference_of_halves(const std::vector<Piece>& pieces) {
    const double usual = usual_motion(pieces);
    const auto size = [usual](const Piece& piece) {
        return std::min(std::abs(piece.integrated_velocity), 3.0 * usual);
    };
    double path = 0.0, so_far = 0.0;
    for (const Piece& piece : pieces) path += size(piece);
    std::vector<Piece> early, late;
    for (const Piece& piece : pieces) {
        (so_far < 0.5 * path ? early : late).push_back(piece);
        so_far += size(piece);
    }
    if (early.size() < 3 || late.size() < 3) return 0.0;
    return 0.5 * std::abs(robust_fit(early).factor - robust_fit(late).factor);
}

struct NamedFactor {
    double factor;
    std::string_view cause;
};

constexpr double pi = std::numbers::pi;
constexpr std::array named_factors = {
    NamedFactor{180.0 / pi,
                "57.3 = 180/pi: the velocity is in rad/s and was taken as deg/s, or the position is in "
                "degrees and was taken as rad"},
    NamedFactor{pi / 180.0,
                "0.01745 = pi/180: the velocity is in deg/s and was taken as rad/s, or the position is in "
                "radians and was taken as deg"},
    NamedFactor{60.0, "60: the time is in minutes, or the velocity per second and was taken per minute"},
    NamedFactor{1.0 / 60.0, "1/60: the velocity is per minute and was taken per second"},
    NamedFactor{6.0, "6: the velocity is in rpm and was taken as deg/s"},
    NamedFactor{1.0 / 6.0, "1/6: the velocity is in deg/s and was taken as rpm"},
    NamedFactor{2.0 * pi,
                "2 pi: the velocity is in turns a second and was taken as rad/s, or the position in radians "
                "and was taken as turns"},
    NamedFactor{0.5 / pi, "1/(2 pi): the velocity is in rad/s and was taken as turns a second"},
    NamedFactor{1000.0, "1000: the time is in seconds and was taken as ms"},
    NamedFactor{0.001, "0.001: the time is in milliseconds and was taken as s"},
    NamedFactor{1e6, "1e6: the time is in seconds and was taken as us"},
    NamedFactor{1e-6, "1e-6: the time is in microseconds and was taken as s"},
    NamedFactor{360.0, "360: the velocity is in turns a second and was taken as deg/s"},
    NamedFactor{1.0 / 360.0, "1/360: the position is in turns and was taken as deg"},
};

std::string start_of(double factor) {
    return fmt::format("position changes {:.4g} times as much as velocity and time imply", factor);
}

std::string explain(double factor, Hertz sample_rate) {
    const bool wrong_clock = factor > 0.5 && factor < 2.0;
    if (!wrong_clock) return factor_in_words(factor);
    return fmt::format(
        "{}: the clock is wrong by this factor (the sample rate is then {:.4g} Hz, not {:.4g} Hz), or one of "
        "the two is not in the unit stated",
        start_of(factor), sample_rate.value() / factor, sample_rate.value());
}

}  // namespace

std::vector<double> advancing_steps(std::span<const double> time_s) {
    std::vector<double> steps;
    for (std::size_t k = 1; k < time_s.size(); ++k)
        if (time_s[k] > time_s[k - 1]) steps.push_back(time_s[k] - time_s[k - 1]);
    return steps;
}

StepSums sum_up_steps(std::span<const double> time_s, double usual_s) noexcept {
    return in_lanes<SumUp>(time_s, usual_s);
}

Hertz nominal_rate(Hertz measured) {
    const double rate = measured.value();
    if (!(rate > 0.0) || !std::isfinite(rate)) return measured;
    if (const double round_rate = two_digits(rate); near(rate, round_rate)) return Hertz(round_rate);
    if (const double period = two_digits(1.0 / rate); near(rate, 1.0 / period)) {
        const double by_period = 1.0 / period;
        // 1 / 0.008 is 125 but for rounding.
        return Hertz(std::abs(by_period - std::round(by_period)) < 1e-9 * by_period ? std::round(by_period)
                                                                                    : by_period);
    }
    return measured;
}

RateEstimate estimate_rate(std::span<const double> time_s) {
    std::vector<double> advancing = advancing_steps(time_s);
    if (advancing.empty()) return {};
    RateEstimate rate;
    rate.step_s = median_in(advancing);
    const double limit_s = gap_steps * rate.step_s;
    double duration = 0.0;
    std::size_t gaps = 0;
    for (const double step : advancing) {
        gaps += step > limit_s;
        duration += step > limit_s ? 0.0 : step;
    }
    const double steps = static_cast<double>(time_s.size() - 1);
    const double mean_s = duration / (steps - static_cast<double>(gaps));
    rate.mean = Hertz(1.0 / mean_s);
    const bool repeats = steps - static_cast<double>(advancing.size()) > few_repeats * steps;
    const bool lost = !repeats && cluster(advancing, rate.step_s) &&
                      furthest_from_even(time_s, mean_s, limit_s) > even_steps * rate.step_s;
    rate.nominal = nominal_rate(lost ? Hertz(1.0 / rate.step_s) : rate.mean);
    return rate;
}

std::vector<LogWarning> clock_warnings(const ClockFacts& clock) {
    std::vector<LogWarning> warnings;
    if (clock.gap_count > 0) warnings.push_back({"gaps", gaps_in_words(clock)});
    if (!clock.rate_changes.empty()) warnings.push_back({"changes of rate", changes_in_words(clock)});
    if (clock.repeated_times > 0) {
        warnings.push_back(
            {"repeated times", fmt::format("{} rows ({} %) repeat the time of the row before: the clock is "
                                           "coarser than the rows, or rows were doubled",
                                           clock.repeated_times,
                                           percent_text(100.0 * static_cast<double>(clock.repeated_times) /
                                                        static_cast<double>(clock.rows)))});
    }
    const double mean = clock.mean_rate.value(), nominal = clock.nominal_rate.value();
    if (nominal > 0.0 && std::abs(mean / nominal - 1.0) > rate_worth_a_word) {
        warnings.push_back(
            {"mean rate", fmt::format("mean rate {:.6g} Hz, typical step {:.6g} ms ({:.6g} Hz): samples are "
                                      "missing or delayed; filters are designed for {:.6g} Hz",
                                      mean, 1e3 / nominal, nominal, nominal)});
    }
    return warnings;
}

std::string factor_in_words(double factor) {
    const std::string start = start_of(factor);
    if (factor < 0.0) return fmt::format("{}: velocity and position have opposite signs", start);
    for (const NamedFactor& named : named_factors) {
        if (std::abs(factor / named.factor - 1.0) < factor_agreement)
            return fmt::format("{}; {}", start, named.cause);
    }
    if (factor >= 5.0) {
        return fmt::format(
            "{}: the position may be that of the motor, {:.4g} being the gear ratio, or a unit is wrong",
            start, factor);
    }
    if (factor <= 0.2) {
        return fmt::format(
            "{}: the velocity may be that of the motor, {:.4g} being the gear ratio, or a unit is wrong",
            start, 1.0 / factor);
    }
    return fmt::format("{}: the position may be another joint's, or the clock or a unit is wrong", start);
}

MotionPieces::MotionPieces(std::size_t rows)
    : rows_(rows), rows_in_piece_(std::max(shortest_piece, rows / most_pieces_checked)) {}

void MotionPieces::end_piece() {
    if (in_piece_ >= shortest_piece) pieces_.push_back(piece_);
    piece_ = {};
    in_piece_ = 0;
}

void MotionPieces::add(const TraceView& rows) {
    if (!rows.has_position() || rows.size() == 0) return;
    std::size_t k = 0;
    const auto row = [&](std::size_t i) {
        return Row{rows.time_s[i], rows.velocity_deg_s[i], rows.position_deg[i]};
    };
    if (!before_ || rows.starts_run(0)) {
        end_piece();
        before_ = row(k++);
    }
    Row before = *before_;
    auto next_run = std::upper_bound(rows.run_starts.begin(), rows.run_starts.end(), rows.first_row);
    while (k < rows.size()) {
        const std::size_t run_end = next_run == rows.run_starts.end()
                                        ? rows.size()
                                        : std::min(*next_run - rows.first_row, rows.size());
        const std::size_t end = std::min(run_end, k + rows_in_piece_ - in_piece_);
        in_piece_ += end - k;
        Piece piece = piece_;
        for (; k < end; ++k) {
            const Row now = row(k);
            const double step = now.time_s - before.time_s;
            piece.position_change += now.position_deg - before.position_deg;
            piece.velocity_change += now.velocity_deg_s - before.velocity_deg_s;
            piece.integrated_velocity += 0.5 * (before.velocity_deg_s + now.velocity_deg_s) * step;
            before = now;
        }
        piece_ = piece;
        if (in_piece_ == rows_in_piece_) end_piece();
        if (k < run_end || k == rows.size()) continue;
        end_piece();
        before = row(k++);
        ++next_run;
    }
    before_ = before;
}

ClockCheck MotionPieces::check(Hertz sample_rate) {
    end_piece();
    if (rows_ < 2 * shortest_piece || pieces_.size() < 3 || !(usual_motion(pieces_) > 0.0)) return {};
    const Fit fit = robust_fit(pieces_);
    const double doubt = std::max(fit.doubt, difference_of_halves(pieces_));
    // A log at rest, or one whose position is of something else: no factor is better than a wrong one.
    if (!std::isfinite(fit.factor) || fit.factor == 0.0 || !(doubt < widest_doubt * std::abs(fit.factor)))
        return {};
    ClockCheck check{fit.factor, {}};
    if (std::abs(fit.factor - 1.0) > std::max(factor_agreement, 3.0 * doubt))
        check.warning = explain(fit.factor, sample_rate);
    return check;
}

}  // namespace ripplenotch
