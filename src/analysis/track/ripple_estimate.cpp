// SPDX-License-Identifier: MIT
#include "ripplenotch/analysis/ripple_estimate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>

#include "analysis/shared_limits.hpp"
#include "analysis/track/cut_windows.hpp"
#include "core/functions/many_numbers.hpp"
#include "core/matrices/factorisations.hpp"
#include "core/vectors/dot.hpp"
#include "ripplenotch/analysis/line_test.hpp"
#include "ripplenotch/analysis/order_track.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/median.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

constexpr double fewest_periods = 4.0;  // per segment: fewer are not distinguished from the trend
// Of the motor, as RippleMeter measures: a resolution at which the families of both splines, Kg and Kg + 1
// times per output turn, are one line.
constexpr double longest_turns = 8.0;
constexpr double trend_terms_per_turn = 12.0;
constexpr double periods_per_trend_term = 2.0;
constexpr double fewest_cosines = 3.0;
constexpr std::size_t most_estimate_samples =
    300'000;                                // by hand: bounds the cost; segments are left out evenly
constexpr double least_range_share = 1e-4;  // as MotionLinesOptions::least_share
constexpr double largest_inflation = 10.0;  // of the variance by neighbouring orders and the trend, by hand
constexpr double agreeing_share = 0.5;      // of the power that segments have in common, for a phase
constexpr double normal_99 = 2.3263478740408408;  // one-sided quantile of 0.99
// A bin 1.5 resolutions away has 3 % of a Hann line's power; bins are independent every 1.5 resolutions.
constexpr double nearest_probe = 1.5, independent_spacing = 1.5;
// Averages that know a mean as well as one value of a median of them does, as in exceedance().
constexpr double median_knowledge_of_mean = 0.48;
constexpr std::size_t probes_a_side = 6;
// Of the noise in neighbouring Hann windows that overlap by half (Welch 1967).
constexpr double window_correlation = 1.0 / 6.0;

/// The motion of one log.
struct Moving {
    const TraceView* log;
    std::vector<double> turns, speed_deg_s;  ///< of the motor; of the joint
    bool absolute_angle = false;
};

struct Segment {
    const Moving* moving;
    SampleRun run;
};

/// What one segment has at one order.
struct SegmentAmplitude {
    std::complex<double> value;  ///< a - ib of a cos + b sin
    double weight = 0.0;         ///< angle under the window
    double inflation = 1.0;      ///< of the variance, since neighbours and trend are fitted along
    std::array<double, 2 * probes_a_side> noise{};  ///< power beside the order; nan where nothing may be read
};

struct OrderSegments {
    std::vector<SegmentAmplitude> segments;
    double cycles = 0.0, slowest_deg_s = std::numeric_limits<double>::max(), fastest_deg_s = 0.0;
    bool collinear = false, few_samples = false;  ///< in a segment that holds enough periods
    bool absolute_angle = true;

    void add(const SegmentAmplitude& amplitude, const Segment& segment, double periods) {
        segments.push_back(amplitude);
        cycles += periods;
        absolute_angle = absolute_angle && segment.moving->absolute_angle;
        for (std::size_t k = segment.run.first; k < segment.run.end; ++k) {
            slowest_deg_s = std::min(slowest_deg_s, std::abs(segment.moving->speed_deg_s[k]));
            fastest_deg_s = std::max(fastest_deg_s, std::abs(segment.moving->speed_deg_s[k]));
        }
    }
};

/// Least squares in one segment.
class SegmentFit {
  public:
    /// `orders` are those that the segment holds enough periods of, lowest first.
    SegmentFit(const Segment& segment, GearRatio ratio, std::span<const double> orders)
        : turns_(std::span(segment.moving->turns).subspan(segment.run.first, segment.run.size())),
          length_(std::abs(turns_.back() - turns_.front())),
          orders_(orders) {
        const double output_turns = length_ / ratio.value();
        const double most =
            std::min(trend_terms_per_turn * output_turns, orders.front() * length_ / periods_per_trend_term);
        cosines_ = static_cast<std::size_t>(std::max(fewest_cosines, std::round(most)));
        root_weight_.resize(samples());
        for (std::size_t k = 0; k < samples(); ++k) {
            const double u = std::clamp(std::abs(turns_[k] - turns_.front()) / length_, 0.0, 1.0);
            const std::size_t at = segment.run.first + k;
            const double angle = std::abs(segment.moving->speed_deg_s[at]);  // per sample, up to a factor
            root_weight_[k] = std::sqrt(angle) * portable::sin(std::numbers::pi * u);
            place_.push_back(u);
        }
        weight_ = dot(root_weight_.data(), root_weight_.data(), samples());
        fill_columns();
        residual_.resize(samples());
        for (std::size_t k = 0; k < samples(); ++k)
            residual_[k] = root_weight_[k] * segment.moving->log->torque_nm[segment.run.first + k];
    }

    [[nodiscard]] bool has_enough_samples() const { return samples() >= 2 * columns_.size(); }

    void solve() {
        const auto n = static_cast<Eigen::Index>(columns_.size());
        Eigen::VectorXd scale(n), right(n);
        Eigen::MatrixXd normal(n, n);
        for (Eigen::Index i = 0; i < n; ++i) {
            right[i] = dot(column(i), residual_.data(), samples());
            for (Eigen::Index j = 0; j <= i; ++j) normal(i, j) = dot(column(i), column(j), samples());
            scale[i] = 1.0 / std::sqrt(std::max(normal(i, i), 1e-300));
        }
        normal = scale.asDiagonal() * normal * scale.asDiagonal();
        const SymmetricFactors factors(normal);
        const Eigen::VectorXd scaled_right = scale.asDiagonal() * right;
        coefficients_ = scale.asDiagonal() * factors.solve(scaled_right);
        const Eigen::Index lines = static_cast<Eigen::Index>(2 * orders_.size());
        Eigen::MatrixXd units = Eigen::MatrixXd::Zero(n, lines);
        units.bottomRows(lines).setIdentity();
        const Eigen::MatrixXd inverse = factors.solve(units);
        for (Eigen::Index i = 0; i < lines; i += 2)
            inflation_.push_back(0.5 * (inverse(n - lines + i, i) + inverse(n - lines + i + 1, i + 1)));
        for (Eigen::Index i = 0; i < n; ++i)
            add_scaled(-coefficients_[i], column(i), residual_.data(), samples());
    }

    [[nodiscard]] bool collinear(std::size_t i) const { return !(inflation_[i] < largest_inflation); }

    [[nodiscard]] SegmentAmplitude amplitude(std::size_t i) const {
        const auto at = coefficients_.size() - static_cast<Eigen::Index>(2 * (orders_.size() - i));
        SegmentAmplitude found{{coefficients_[at], -coefficients_[at + 1]}, weight_, inflation_[i]};
        for (std::size_t p = 0; p < found.noise.size(); ++p) {
            const double apart = (nearest_probe + static_cast<double>(p / 2)) / length_;
            found.noise[p] = power_at(orders_[i] + (p % 2 == 0 ? -apart : apart));
        }
        return found;
    }

  private:
    [[nodiscard]] std::size_t samples() const { return turns_.size(); }
    [[nodiscard]] const double* column(Eigen::Index i) const {
        return columns_[static_cast<std::size_t>(i)].data();
    }

    void fill_columns() {
        columns_.assign(2 + cosines_ + 2 * orders_.size(), std::vector<double>(samples()));
        for (std::size_t k = 0; k < samples(); ++k) {
            columns_[0][k] = root_weight_[k];
            columns_[1][k] = root_weight_[k] * (place_[k] - 0.5);
            const double cosine = portable::cos(std::numbers::pi * place_[k]);
            double before = 1.0, now = cosine;  // Chebyshev's recurrence gives the cosines of multiples
            for (std::size_t m = 0; m < cosines_; ++m) {
                columns_[2 + m][k] = root_weight_[k] * now;
                const double next = 2.0 * cosine * now - before;
                before = now;
                now = next;
            }
        }
        for (std::size_t i = 0; i < orders_.size(); ++i)
            fill_wave(orders_[i], columns_[2 + cosines_ + 2 * i], columns_[3 + cosines_ + 2 * i]);
    }

    void fill_wave(double order, std::vector<double>& cosine, std::vector<double>& sine) const {
        std::vector<double> angle(samples());
        for (std::size_t k = 0; k < samples(); ++k) angle[k] = 2.0 * std::numbers::pi * order * turns_[k];
        portable::phasors(angle, cosine, sine);
        for (std::size_t k = 0; k < samples(); ++k) {
            cosine[k] *= root_weight_[k];
            sine[k] *= root_weight_[k];
        }
    }

    /// Squared amplitude of the residual at an order; nan next to the trend and to other orders, whose fit
    /// took the noise there along.
    [[nodiscard]] double power_at(double order) const {
        const double clear = nearest_probe / length_;
        bool taken = order * length_ < 0.5 * static_cast<double>(cosines_) + nearest_probe;
        for (const double other : orders_) taken = taken || std::abs(order - other) < 0.99 * clear;
        if (taken) return not_a_number;
        std::vector<double> cosine(samples()), sine(samples());
        fill_wave(order, cosine, sine);
        const double c = dot(cosine.data(), residual_.data(), samples());
        const double s = dot(sine.data(), residual_.data(), samples());
        return 4.0 * (c * c + s * s) / (weight_ * weight_);
    }

    std::span<const double> turns_;
    double length_;  ///< in motor turns
    std::span<const double> orders_;
    std::size_t cosines_ = 0;
    double weight_ = 0.0;
    std::vector<double> place_, root_weight_, residual_;
    std::vector<std::vector<double>> columns_;  ///< each multiplied by the root of the weight
    Eigen::VectorXd coefficients_;
    std::vector<double> inflation_;
};

std::vector<Moving> moving_of(std::span<const TraceView> logs, GearRatio ratio) {
    std::vector<Moving> all;
    for (const TraceView& log : logs) {
        OutputAngle angle = output_angle(log);
        for (double& turns : angle.turns) turns *= ratio.value();
        all.push_back({&log, std::move(angle.turns), smoothed_speed(log), angle.absolute});
    }
    return all;
}

/// Motion in one direction, slower than a speed.
std::vector<SampleRun> slower_runs(const Moving& moving, double limit_deg_s) {
    std::vector<SampleRun> slower;
    for (const SampleRun& run : directed_runs(moving.speed_deg_s, moving.log->run_starts, {})) {
        bool inside = false;
        for (std::size_t k = run.first; k < run.end; ++k) {
            const bool slow = std::abs(moving.speed_deg_s[k]) < limit_deg_s;
            if (slow && !inside) slower.push_back({k, k});
            if (slow) slower.back().end = k + 1;
            inside = slow;
        }
    }
    return slower;
}

/// Segments of all logs, none longer than `longest` motor turns nor shorter than `shortest`.
std::vector<Segment> cut_segments(std::span<const Moving> logs, double limit_deg_s, double longest,
                                  double shortest) {
    std::vector<Segment> all;
    std::size_t samples = 0;
    for (const Moving& moving : logs) {
        for (const SampleRun& run : slower_runs(moving, limit_deg_s)) {
            for (const SampleRun& window : cut_windows(run, moving.turns, longest, shortest, 0.5)) {
                if (window.size() < 3) continue;
                all.push_back({&moving, window});
                samples += window.size();
            }
        }
    }
    const std::size_t stride = (samples + most_estimate_samples - 1) / most_estimate_samples;
    std::vector<Segment> kept;
    for (std::size_t i = 0; i < all.size(); i += std::max<std::size_t>(stride, 1)) kept.push_back(all[i]);
    return kept;
}

/// Mean power beside an order, as large as the fit of the order sees it, and of how many independent bins.
struct NoisePower {
    double power = 0.0, bins = 0.0;
    /// Between both sides along the slope of the spectrum, where that is more.
    double along_slope = 0.0;
};

NoisePower noise_power(const OrderSegments& order, double averages) {
    std::vector<double> powers, sides[2];
    for (std::size_t p = 0; p < 2 * probes_a_side; ++p) {
        double sum = 0.0, weight = 0.0;
        for (const SegmentAmplitude& one : order.segments) {
            if (!std::isfinite(one.noise[p])) continue;
            sum += one.weight * one.inflation * one.noise[p];
            weight += one.weight;
        }
        if (!(weight > 0.0)) continue;
        powers.push_back(sum / weight);
        sides[p % 2].push_back(sum / weight);
    }
    if (powers.empty()) return {};
    NoisePower noise{median_in(powers) / median_over_mean(averages),
                     static_cast<double>(powers.size()) / independent_spacing};
    noise.along_slope = noise.power;
    if (!sides[0].empty() && !sides[1].empty()) {
        const double between = std::sqrt(median_in(sides[0]) * median_in(sides[1]));
        noise.along_slope = std::max(noise.power, between / median_over_mean(averages));
    }
    return noise;
}

/// How many segments of equal noise power would know as much: slow ones often hold far more than others.
double effective_averages(const OrderSegments& order) {
    double sum = 0.0, squares = 0.0;
    for (const SegmentAmplitude& one : order.segments) {
        double power = 0.0, count = 0.0;
        for (const double noise : one.noise) {
            if (!std::isfinite(noise)) continue;
            power += noise;
            count += 1.0;
        }
        const double share = count > 0.0 ? one.weight * one.inflation * power / count : 0.0;
        sum += share;
        squares += share * share;
    }
    return squares > 0.0 ? sum * sum / squares : 1.0;
}

/// The power over the noise that noise alone exceeds with a probability.
double threshold(double averages, double bins, double false_alarm) {
    double low = 1.0, high = 2.0;
    const auto chance = [&](double ratio) {
        return exceedance({.ratio = ratio, .averages = averages, .cells = median_efficiency * bins});
    };
    while (chance(high) > false_alarm && high < 1e12) high *= 2.0;
    for (int i = 0; i < 60; ++i) {
        const double middle = 0.5 * (low + high);
        (chance(middle) > false_alarm ? low : high) = middle;
    }
    return high;
}

RippleEstimate estimate_of(double value, const OrderSegments& order, std::size_t orders, double least_nm) {
    RippleEstimate found;
    found.order = value;
    found.segments = order.segments.size();
    found.cycles = order.cycles;
    found.slowest_deg_s = order.slowest_deg_s;
    found.fastest_deg_s = order.fastest_deg_s;
    double weight = 0.0, power = 0.0;
    std::complex<double> sum;
    for (const SegmentAmplitude& one : order.segments) {
        weight += one.weight;
        power += one.weight * std::norm(one.value);
        sum += one.weight * one.value;
    }
    const double averages = effective_averages(order);
    power /= weight;
    sum /= weight;
    const NoisePower noise = noise_power(order, averages);
    if (!(noise.bins > 0.0)) {
        found.insufficient = "no order beside it is free to measure the noise at";
        return found;
    }
    double scatter = 0.0;
    for (const SegmentAmplitude& one : order.segments) {
        const double apart = one.weight / weight * (std::norm(one.value) - power);
        scatter += apart * apart;
    }
    scatter *= 1.0 + 2.0 * window_correlation;
    if (averages > 1.5) scatter *= averages / (averages - 1.0);
    const double square = std::max(power - noise.power, 0.0);
    const double variance =
        (2.0 * (1.0 + 2.0 * window_correlation) * square * noise.power + noise.power * noise.power) /
            averages +
        noise.power * noise.power / (averages * noise.bins);
    found.amplitude_nm = std::sqrt(square);
    found.standard_error_nm = std::sqrt(square + std::sqrt(std::max(variance, scatter))) - found.amplitude_nm;
    const double tries = static_cast<double>(orders);
    found.false_alarm = noise.power > 0.0
                            ? std::min(1.0, tries * exceedance({.ratio = power / noise.along_slope,
                                                                .averages = averages,
                                                                .cells = median_efficiency * noise.bins}))
                            : (power > 0.0 ? 0.0 : 1.0);
    // Power of line and noise is about normal, of variance (2 A^2 N + N^2) / averages, and so is the
    // logarithm of the noise, known from the bins to one side, here and in the log it is said of: the A^2 at
    // which the lower percentile of the power is the threshold solves a quadratic.
    const double level = threshold(averages, noise.bins, ripple_false_alarm / tries);
    const double above = level - noise.power / std::max(noise.along_slope, 1e-300);
    const double known = 0.5 * median_knowledge_of_mean * noise.bins * averages;
    const double spread = normal_99 * normal_99 / averages;
    const double doubt = portable::pow(level * (portable::exp(normal_99 * std::sqrt(2.0 / known)) - 1.0), 2);
    const double least = above + spread + std::sqrt(2.0 * above * spread + spread * spread + spread + doubt);
    found.detectable_nm = std::max(std::sqrt(noise.along_slope * least), least_nm);
    if (found.amplitude_nm < least_nm) found.false_alarm = 1.0;
    const double common = std::norm(sum);
    if (order.absolute_angle && common > agreeing_share * power && square > 0.0) {
        const double apart = std::max(noise.power, power - common);
        found.phase_deg = portable::atan2(sum.imag(), sum.real()) * degrees_per_radian;
        found.phase_standard_error_deg = std::sqrt(apart / (2.0 * averages * common)) * degrees_per_radian;
    }
    return found;
}

/// Speeds of the logs, and those at which an order reaches half the sample rate.
struct Limits {
    double fastest_deg_s = 0.0, rate_turns_deg_s = std::numeric_limits<double>::max();

    [[nodiscard]] double deg_s(double order) const { return 0.5 * rate_turns_deg_s / order; }
    [[nodiscard]] bool passed(double order) const { return deg_s(order) <= fastest_deg_s; }
};

Limits limits_of(std::span<const Moving> logs, GearRatio ratio) {
    Limits limits;
    for (const Moving& one : logs) {
        const double turns_deg_s = 360.0 * one.log->sample_rate.value() / ratio.value();
        limits.rate_turns_deg_s = std::min(limits.rate_turns_deg_s, turns_deg_s);
        for (const double speed : one.speed_deg_s)
            limits.fastest_deg_s = std::max(limits.fastest_deg_s, std::abs(speed));
    }
    return limits;
}

/// Orders that stay below half the sample rate share their segments; each other one has its own.
std::vector<OrderSegments> gather_segments(std::span<const Moving> logs, GearRatio ratio,
                                           const Limits& limits, std::span<const double> sorted) {
    std::vector<OrderSegments> gathered(sorted.size());
    for (std::size_t last = sorted.size(); last-- > 0;) {
        const bool shared = !limits.passed(sorted[last]);
        const auto fitted = sorted.first(last + 1);
        const double slower = shared ? 2.0 * limits.fastest_deg_s : limits.deg_s(sorted[last]);
        const double longest = std::max(longest_turns, separating_window_turns(sorted));
        for (const Segment& segment : cut_segments(logs, slower, longest, fewest_periods / sorted[last])) {
            const std::vector<double>& turns = segment.moving->turns;
            const double length = std::abs(turns[segment.run.end - 1] - turns[segment.run.first]);
            const auto first = std::lower_bound(fitted.begin(), fitted.end(), fewest_periods / length);
            if (first == fitted.end()) continue;
            const auto skipped = static_cast<std::size_t>(first - fitted.begin());
            SegmentFit fit(segment, ratio, fitted.subspan(skipped));
            const bool enough = fit.has_enough_samples();
            if (enough) fit.solve();
            for (std::size_t i = shared ? skipped : last; i <= last; ++i) {
                if (!enough)
                    gathered[i].few_samples = true;
                else if (fit.collinear(i - skipped))
                    gathered[i].collinear = true;
                else
                    gathered[i].add(fit.amplitude(i - skipped), segment, sorted[i] * length);
            }
        }
        if (shared) break;
    }
    return gathered;
}

std::string why_none(const OrderSegments& segments, double order, const Limits& limits) {
    if (segments.few_samples) return "too few samples per motor turn for so many orders";
    if (segments.collinear)
        return "the joint nowhere turns far enough in one direction to separate it from its neighbours";
    const std::string where =
        limits.passed(order) ? fmt::format("below {:.3g} deg/s, where it lies under half the sample rate, ",
                                           limits.deg_s(order))
                             : "";
    return where + "the joint nowhere turns four periods of it in one direction";
}

}  // namespace

std::vector<RippleEstimate> estimate_ripple(std::span<const TraceView> logs, GearRatio ratio,
                                            std::span<const Order> orders) {
    if (!(ratio.value() > 0.0)) raise<UsageError>("gear ratio {} is not above 0", shortest(ratio.value()));
    std::vector<double> sorted;
    for (const Order order : orders) {
        if (!(order.value() > 0.0)) raise<UsageError>("order {} is not above 0", shortest(order.value()));
        sorted.push_back(order.value());
    }
    std::sort(sorted.begin(), sorted.end());
    sorted.erase(std::unique(sorted.begin(), sorted.end()), sorted.end());
    const std::vector<Moving> moving = moving_of(logs, ratio);
    const Limits limits = limits_of(moving, ratio);
    const std::vector<OrderSegments> gathered = gather_segments(moving, ratio, limits, sorted);
    const double least_nm = least_amplitude_nm(logs, least_range_share);
    std::vector<RippleEstimate> found;
    for (const Order order : orders) {
        const auto at = std::lower_bound(sorted.begin(), sorted.end(), order.value()) - sorted.begin();
        const OrderSegments& segments = gathered[static_cast<std::size_t>(at)];
        if (!segments.segments.empty()) {
            found.push_back(estimate_of(order.value(), segments, sorted.size(), least_nm));
            continue;
        }
        found.emplace_back().order = order.value();
        found.back().insufficient = why_none(segments, order.value(), limits);
    }
    return found;
}

std::string ripple_text(std::span<const RippleEstimate> estimates) {
    std::string text;
    for (const RippleEstimate& one : estimates) {
        if (!text.empty()) text += "; ";
        text += fmt::format("order {}: ", shortest(one.order));
        if (!one.searched()) {
            text += one.insufficient;
            continue;
        }
        text += one.present() ? fmt::format("{:.3g} +/- {:.1g} Nm", one.amplitude_nm, one.standard_error_nm)
                              : fmt::format("no ripple above {:.2g} Nm", one.detectable_nm);
        text += fmt::format(" at {:.3g} to {:.3g} deg/s", one.slowest_deg_s, one.fastest_deg_s);
    }
    return text;
}

}  // namespace ripplenotch
