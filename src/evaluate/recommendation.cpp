// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <tuple>

#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/portable_math.hpp"
#include "ripplenotch/core/progress.hpp"
#include "ripplenotch/design/notch.hpp"
#include "ripplenotch/evaluate/ledger.hpp"
#include "ripplenotch/evaluate/recommendation.hpp"

namespace ripplenotch {

namespace {

// "attenuates order 1 by 16.0 dB and order 2 by 24.3 dB"
std::string attenuation_text(const JudgedMethod& method, const std::vector<RippleEstimate>& orders) {
    std::vector<std::string> parts;
    for (std::size_t i = 0; i < orders.size(); ++i) {
        if (!orders[i].present() || i >= method.figures.attenuation.size()) continue;
        const OrderAttenuation& entry = method.figures.attenuation[i];
        if (entry.db) parts.push_back(fmt::format("order {:g} by {:.1f} dB", entry.order, *entry.db));
    }
    if (parts.empty()) return "attenuation not measured";
    const std::string last = parts.back();
    parts.pop_back();
    return fmt::format("attenuates {}{}{}", fmt::join(parts, ", "), parts.empty() ? "" : " and ", last);
}

// "no delay at 0 Hz, 0.2 to 9.3 ms of delay at a gain of 0.98 to 1.21 within 0 to 5 Hz, a step overshoots by
// 40 %"
std::string delay_text(const JudgedMethod& method, const TorqueBand& band) {
    const std::string dc_ms = rounded(method.figures.dc_delay_ms.value_or(0.0), 1);
    std::string text = dc_ms == "0.0" ? "no delay at 0 Hz" : fmt::format("{} ms of delay at 0 Hz", dc_ms);
    const double overshoot_percent = method.figures.overshoot_percent.value_or(0.0);
    if (const auto& within = method.response) {
        const std::string least = rounded(1e3 * within->least_delay.value(), 1),
                          longest = rounded(1e3 * within->longest_delay.value(), 1),
                          gain = fmt::format("{:.2f}", within->least_gain),
                          largest = fmt::format("{:.2f}", within->largest_gain);
        const bool passes = dc_ms == "0.0" && least == "0.0" && longest == "0.0" && gain == "1.00" &&
                            largest == "1.00" && overshoot_percent < 0.5;
        if (passes) return "without delay";
        text +=
            fmt::format(", {} ms of delay at a gain of {} within {:.3g} to {:.3g} Hz",
                        least == longest ? least : least + " to " + longest,
                        gain == largest ? gain : gain + " to " + largest, band.from.value(), band.to.value());
    }
    if (overshoot_percent >= 0.5) text += fmt::format(", a step overshoots by {:.0f} %", overshoot_percent);
    return text;
}

std::string short_text(const MethodFigures& figures) {
    constexpr std::size_t longest_text = 60;  // chosen, not derived: a line of the page
    if (figures.method.size() <= longest_text) return figures.method;
    return figures.method.substr(0, figures.method.find(',')) + ",...";
}

bool is_control(const MethodFigures& figures) { return part_of(figures) == MethodPart::control; }

std::string one_sentence(const Recommendation& found, const JudgedMethod& method) {
    return fmt::format("{}, {}, remaining ripple {:.3g} Nm rms", attenuation_text(method, found.orders),
                       delay_text(method, *found.band), method.figures.ripple_rms_nm.value_or(0.0));
}

std::string next_to(const Recommendation& found, const JudgedMethod& taken, const JudgedMethod& other) {
    if (!other.meets() && taken.meets())
        return fmt::format(" Nothing else is within the limits; nearest, {}: {}.", short_text(other.figures),
                           fmt::join(other.shortfalls, "; "));
    const std::string figures = one_sentence(found, other);
    return fmt::format(" Next, {}: {}; output error {:.3g} Nm rms against {:.3g} Nm rms.",
                       short_text(other.figures), figures, other.error_nm, taken.error_nm);
}

}  // namespace

std::string recommendation_verdict(const Recommendation& found) {
    const JudgedMethod* const taken = found.taken();
    if (found.finding == RecommendationFinding::cannot_tell)
        return fmt::format("Cannot tell: {}.", found.why);
    if (found.finding == RecommendationFinding::no_ripple)
        return fmt::format("No filter recommended: {}.", found.why);
    if (taken == nullptr) return "No method was tried.";
    const JudgedMethod* const other = found.runner_up();
    if (found.finding == RecommendationFinding::out_of_reach) {
        return fmt::format("Nothing is within the limits. The nearest is {}: {} ({}).",
                           short_text(taken->figures), fmt::join(taken->shortfalls, "; "),
                           one_sentence(found, *taken));
    }
    std::string text;
    if (!is_control(taken->figures)) {
        text = fmt::format("Use {}: {}.", short_text(taken->figures), one_sentence(found, *taken));
    } else {
        text = fmt::format("Leave the torque as it is{} ({:.3g} Nm rms).",
                           other != nullptr && !other->meets()
                               ? ", with its ripple"
                               : ": a filter would distort more than the ripple that it removes",
                           taken->figures.ripple_rms_nm.value_or(0.0));
    }
    if (other != nullptr) text += next_to(found, *taken, *other);
    return text;
}

void judge(Comparison& comparison, std::span<const Contender> contenders, const ComparedLog& log,
           const RecommendationLimits& limits) {
    if (comparison.subject() == nullptr || !comparison.lines) return;
    const GearAccount& lines = *comparison.lines;
    Recommendation found = recommend(
        contenders, log, lines, limits, estimate_ripple({&log.trace, 1}, lines.ratio, lines.orders),
        std::nullopt,
        LogLevels{comparison.methods, comparison.windows, comparison.measured_share, comparison.why_none});
    comparison.best_sentence = recommendation_verdict(found);
    if (found.finding == RecommendationFinding::recommended)
        comparison.best = std::move(found.methods.front());
}

namespace {

constexpr double slow_turn_s = 0.5;        // chosen, not derived
constexpr NewtonMeters judged_step{10.0};  // as compare takes on a log
constexpr Seconds run_in{2.0};             // chosen, not derived: the motor has turned several times
// Speeds of the log at which delays within the band are looked at, alike many rows apart.
constexpr std::size_t speeds_judged = 9;

std::pair<Seconds, DegPerSec> longest_of(const Contender& contender, Hertz sample_rate, DegPerSec slowest,
                                         DegPerSec fastest) {
    if (contender.table == nullptr) {
        const LongestDelay longest = longest_delay(contender, sample_rate, {slowest, fastest});
        return {longest.delay, longest.speed};
    }
    std::pair<Seconds, DegPerSec> longest{Seconds(0.0), fastest};
    for (const Band& band : contender.table->bands()) {
        if (!(band.from < fastest) || band.to < slowest) continue;
        const Seconds delay = group_delay(band.cascade(), Hertz(0.0), SampledAt(sample_rate));
        if (delay > longest.first) longest = {delay, 0.5 * (band.from + band.to)};
    }
    return longest;
}

std::optional<OrderAttenuation> weakest_of(const MethodFigures& figures,
                                           const std::vector<RippleEstimate>& orders) {
    std::optional<OrderAttenuation> weakest;
    for (std::size_t i = 0; i < figures.attenuation.size(); ++i) {
        const OrderAttenuation& entry = figures.attenuation[i];
        if (!orders[i].present() || !entry.db) continue;
        if (!weakest || *entry.db < *weakest->db) weakest = entry;
    }
    return weakest;
}

void hold_to(JudgedMethod& method, const RecommendationLimits& limits,
             const std::vector<RippleEstimate>& orders) {
    for (std::size_t i = 0; limits.min_attenuation_db && i < method.figures.attenuation.size(); ++i) {
        const OrderAttenuation& entry = method.figures.attenuation[i];
        const double limit = *limits.min_attenuation_db, db = entry.db.value_or(0.0);
        if (!orders[i].present() || db >= limit) continue;
        method.shortfalls.push_back(
            fmt::format("attenuates order {:g} by {:.1f} dB, {:.1f} dB less than {:g} dB", entry.order, db,
                        limit - db, limit));
        method.excess += (limit - db) / std::max(limit, 1.0);
    }
    if (!limits.max_delay || method.delay <= *limits.max_delay) return;
    const double limit_ms = 1e3 * limits.max_delay->value(), delay_ms = 1e3 * method.delay.value();
    method.shortfalls.push_back(fmt::format("{:.1f} ms of delay at {:.3g} deg/s, {:.1f} ms more than {:g} ms",
                                            delay_ms, method.delay_at.value(), delay_ms - limit_ms,
                                            limit_ms));
    method.excess += (delay_ms - limit_ms) / std::max(limit_ms, 1.0);
}

// |v| of a log, slowest first.
std::vector<double> speeds_of(const TraceView& trace) {
    std::vector<double> speeds;
    for (const double velocity : trace.velocity_deg_s) speeds.push_back(std::abs(velocity));
    std::sort(speeds.begin(), speeds.end());
    return speeds;
}

// What the method costs, in addition to what it leaves.
JudgedMethod judged(const Contender& contender, MethodFigures&& measured, const TraceView& trace,
                    const std::vector<double>& speeds, const Recommendation& found) {
    JudgedMethod method;
    method.figures = std::move(measured);
    const DegPerSec median = median_moving_speed(trace);
    const MethodFigures at_median =
        measure_on_signals(contender, trace.sample_rate, median, std::nullopt, std::nullopt, nullptr);
    method.figures.dc_delay_ms = at_median.dc_delay_ms;
    method.figures.note = at_median.note;
    try {
        const Bench bench(contender, trace.sample_rate, median);
        method.figures.overshoot_percent = bench.step(judged_step, run_in).overshoot_percent;
    } catch (const UsageError&) {
        // A filter that does not settle has no such figure; the others still count.
    }
    std::tie(method.delay, method.delay_at) =
        longest_of(contender, trace.sample_rate, DegPerSec(speeds.front()), DegPerSec(speeds.back()));
    method.response = band_response(contender, trace.sample_rate, median, *found.band);
    const auto moving = std::upper_bound(speeds.begin(), speeds.end(), speeds.back() / 20.0);
    for (std::size_t i = 0; i < speeds_judged && moving != speeds.end(); ++i) {
        const auto apart = static_cast<std::size_t>(speeds.end() - moving - 1);
        const DegPerSec speed(moving[static_cast<std::ptrdiff_t>(apart * i / (speeds_judged - 1))]);
        const auto response = band_response(contender, trace.sample_rate, speed, *found.band);
        if (!response || response->longest_delay <= method.delay) continue;
        method.delay = response->longest_delay;
        method.delay_at = speed;
    }
    method.weakest = weakest_of(method.figures, found.orders);
    return method;
}

bool better(const JudgedMethod& a, const JudgedMethod& b) {
    if (a.meets() != b.meets()) return a.meets();
    if (!a.meets() && a.excess != b.excess) return a.excess < b.excess;
    return a.error_nm < b.error_nm;
}

std::string name_of(const MethodFigures& figures) {
    return figures.method.substr(0, figures.method.find(','));
}

}  // namespace

std::string_view recommendation_finding_name(RecommendationFinding finding) {
    switch (finding) {
        case RecommendationFinding::recommended:
            return "recommended";
        case RecommendationFinding::out_of_reach:
            return "out-of-reach";
        case RecommendationFinding::no_ripple:
            return "no-ripple";
        case RecommendationFinding::cannot_tell:
            break;
    }
    return "cannot-tell";
}

const JudgedMethod* Recommendation::runner_up() const {
    for (const JudgedMethod& method : methods)
        if (name_of(method.figures) != name_of(methods.front().figures)) return &method;
    return nullptr;
}

double torque_rate_nm_s(const TraceView& trace, GearRatio ratio) {
    double squares = 0.0, lasted_s = 0.0;                                      // sums over all turns
    double turned = 0.0, torque = 0.0, time = 0.0, rows = 0.0, began_s = 0.0;  // sums over the current turn
    std::optional<std::pair<double, double>> before;  // time and torque of the one before
    for (std::size_t k = 0; k < trace.size(); ++k) {
        if (k == 0 || trace.starts_run(k)) {
            before.reset();
            turned = torque = time = rows = 0.0;
        } else {
            const double step_s = trace.time_s[k] - trace.time_s[k - 1];
            turned += ratio.value() * std::abs(trace.velocity_deg_s[k]) * step_s / 360.0;
        }
        if (rows == 0.0) began_s = trace.time_s[k];
        torque += trace.torque_nm[k];
        time += trace.time_s[k];
        rows += 1.0;
        if (turned < 1.0 && trace.time_s[k] - began_s < slow_turn_s) continue;
        const std::pair<double, double> now{time / rows, torque / rows};
        if (before && now.first > before->first) {
            const double step_s = now.first - before->first;
            const double rate = (now.second - before->second) / step_s;
            squares += rate * rate * step_s;
            lasted_s += step_s;
        }
        before = now;
        turned = torque = time = rows = 0.0;
    }
    return lasted_s > 0.0 ? std::sqrt(squares / lasted_s) : 0.0;
}

Recommendation recommend(std::span<const Contender> contenders, const ComparedLog& log,
                         const GearAccount& lines, const RecommendationLimits& limits,
                         std::vector<RippleEstimate> ripple, std::optional<TorqueBand> band,
                         std::optional<LogLevels> measured) {
    Recommendation found;
    found.limits = limits;
    found.orders = std::move(ripple);
    if (std::none_of(found.orders.begin(), found.orders.end(), std::mem_fn(&RippleEstimate::present))) {
        const bool searched =
            std::all_of(found.orders.begin(), found.orders.end(), std::mem_fn(&RippleEstimate::searched));
        if (searched) found.finding = RecommendationFinding::no_ripple;
        found.why = ripple_text(found.orders);
        return found;
    }
    LogLevels levels = measured ? std::move(*measured) : measure_on_log(contenders, log, lines);
    found.windows = levels.windows;
    if (levels.windows < fewest_judged_windows) {
        found.why = levels.windows == 0
                        ? fmt::format("nothing can be judged on this log: {}", levels.why_none)
                        : fmt::format(
                              "the part of the log to judge by is too short: {} window{} of eight motor "
                              "turns, and {} are needed",
                              levels.windows, levels.windows == 1 ? "" : "s", fewest_judged_windows);
        return found;
    }
    found.torque_rate_nm_s = torque_rate_nm_s(log.trace, lines.ratio);
    const TorqueReference reference(log, lines, found.orders, band);
    found.band = reference.band();
    const std::vector<double> speeds = speeds_of(log.trace);
    Progress::current().begin("judging", "methods", contenders.size());
    for (std::size_t i = 0; i < contenders.size(); ++i, Progress::current().add(1)) {
        JudgedMethod method = judged(contenders[i], std::move(levels.methods[i]), log.trace, speeds, found);
        method.distortion = reference.distortion(contenders[i]);
        method.error_nm = portable::hypot(
            portable::hypot(method.figures.ripple_rms_nm.value_or(0.0), method.distortion.in_band_nm),
            method.distortion.added_nm);
        hold_to(method, limits, found.orders);
        found.methods.push_back(std::move(method));
    }
    std::stable_sort(found.methods.begin(), found.methods.end(), better);
    const bool any = !found.methods.empty() && found.methods.front().meets();
    found.finding = any ? RecommendationFinding::recommended : RecommendationFinding::out_of_reach;
    return found;
}

}  // namespace ripplenotch
