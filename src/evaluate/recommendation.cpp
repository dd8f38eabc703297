// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <tuple>

#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/gear_account.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/portable_math.hpp"
#include "ripplenotch/core/progress.hpp"
#include "ripplenotch/design/notch.hpp"
#include "ripplenotch/evaluate/recommendation.hpp"

namespace ripplenotch {

namespace {

// Words for a sentence of a page.
constexpr std::size_t longest_method_name = 60, most_orders_named = 2;

}  // namespace

std::string short_method(const MethodFigures& figures) {
    Spec spec = parse_spec(figures.method);
    std::erase_if(spec.values,
                  [](const auto& entry) { return entry.first == "gear-ratio" || entry.first == "orders"; });
    const std::string text = spec.text();
    return text.size() <= longest_method_name ? text : spec.name;
}

namespace {

// "a ripple map (map.json)", "tracking notches (tracking,q=1)", "an oscillator"
std::string noun_of(const MethodFigures& figures) {
    const Spec spec = parse_spec(figures.method);
    const Method& method = find_method(spec.name);
    std::string made_of = short_method(figures);
    for (const auto& [key, value] : spec.values)
        if ((key == "map" && method.is_map) || (key == "table" && method.needs_table)) made_of = value;
    if (method.noun.ends_with(made_of)) return std::string(method.noun);
    return fmt::format("{} ({})", method.noun, made_of);
}

// "order 1 down 9 dB, order 2 down 10 dB"
std::string attenuation_text(const Recommendation& found, const MethodFigures& figures) {
    std::vector<std::string> parts;
    std::vector<double> db;
    for (std::size_t i = 0; i < found.orders.size() && i < figures.attenuation.size(); ++i) {
        const OrderAttenuation& entry = figures.attenuation[i];
        if (!found.asks_for(i) || !entry.db) continue;
        parts.push_back(fmt::format("{} down {} dB", entry.name(), rounded(*entry.db, 0)));
        db.push_back(*entry.db);
    }
    if (parts.empty()) return "attenuation not known";
    if (parts.size() <= most_orders_named) return fmt::format("{}", fmt::join(parts, ", "));
    const auto [least, most] = std::minmax_element(db.begin(), db.end());
    return fmt::format("{} orders down {} to {} dB", parts.size(), rounded(*least, 0), rounded(*most, 0));
}

std::string delay_text(const JudgedMethod& method) {
    if (!method.delay) return "delay not known";
    const std::string ms = rounded(1e3 * method.delay->value(), 1);
    return ms == "0.0" ? "no delay" : fmt::format("at most {} ms delay", ms);
}

// "0.10"
std::string two_digits(double value) {
    const double size = portable::log10(std::max(std::abs(value), 1e-9));
    return rounded(value, std::clamp(1 - static_cast<int>(std::floor(size)), 0, 9));
}

std::string error_text(const Recommendation& found, const JudgedMethod& method) {
    const std::string error = two_digits(method.error_nm()), least = two_digits(found.taken()->error_nm());
    return error == least ? fmt::format("the same error of {} Nm rms", error)
                          : fmt::format("error {} instead of {} Nm rms", error, least);
}

// Chosen, not derived: what is a trade, and how much larger the error of it may be.
constexpr double less_delay_ms = 0.5, less_overshoot_percent = 10.0, less_cost = 0.5, larger_error = 1.5;

// What it has less of than the one to take, at least; empty where it trades nothing.
std::string traded(const JudgedMethod& taken, const JudgedMethod& other) {
    if (taken.delay && other.delay && 1e3 * (*taken.delay - *other.delay).value() >= less_delay_ms)
        return fmt::format("{} ms less delay", rounded(1e3 * (*taken.delay - *other.delay).value(), 1));
    const double mine = taken.figures.overshoot_percent.value_or(0.0),
                 theirs = other.figures.overshoot_percent.value_or(mine);
    if (mine - theirs >= less_overshoot_percent)
        return fmt::format("{} instead of {} % overshoot", rounded(theirs, 0), rounded(mine, 0));
    if (other.multiplications <= less_cost * taken.multiplications)
        return fmt::format("{:.0f} instead of {:.0f} multiplications per sample", other.multiplications,
                           taken.multiplications);
    return "";
}

bool is_control(const MethodFigures& figures) { return part_of(figures) == MethodPart::control; }

}  // namespace

std::string recommendation_verdict(const Recommendation& found) {
    const JudgedMethod* const taken = found.taken();
    if (found.finding == RecommendationFinding::cannot_tell)
        return fmt::format("Cannot tell: {}.", found.why);
    if (found.finding == RecommendationFinding::no_ripple)
        return fmt::format("No filter recommended: {}.", found.why);
    if (taken == nullptr) return "No method was tried.";
    const bool is_reached = found.finding != RecommendationFinding::out_of_reach;
    if (!is_reached && is_control(taken->figures)) return fmt::format("None fits: {}.", found.why);
    if (!is_reached)
        return fmt::format("None fits: the nearest is {} at {}.", short_method(taken->figures),
                           taken->shortfalls.front());
    if (is_control(taken->figures)) {
        const auto best =
            std::find_if(found.methods.begin() + 1, found.methods.end(), std::mem_fn(&JudgedMethod::meets));
        return fmt::format(
            "Leave the torque as it is: each filter tried errs by more than its ripple. The best, {}: {}.",
            short_method(best->figures), error_text(found, *best));
    }
    std::string text = fmt::format("Use {}: {}, {}; {} Nm of {} Nm rms is left.", noun_of(taken->figures),
                                   attenuation_text(found, taken->figures), delay_text(*taken),
                                   two_digits(taken->figures.ripple_rms_nm.value_or(0.0)),
                                   two_digits(found.raw_ripple_rms_nm));
    if (const JudgedMethod* const other = found.runner_up())
        text += fmt::format(" With {}: {}, {}.", traded(*taken, *other), short_method(other->figures),
                            error_text(found, *other));
    return text;
}

void judge(Comparison& comparison, std::span<const Contender> contenders, const ComparedLog& log,
           const RecommendationLimits& limits, LogLevels measured) {
    if (comparison.subject() == nullptr || !comparison.lines) return;
    const GearAccount& lines = *comparison.lines;
    const Recommendation found =
        recommend(contenders, log, lines, limits, {}, std::nullopt, std::move(measured));
    comparison.best_sentence = recommendation_verdict(found);
    if (found.finding == RecommendationFinding::recommended) comparison.best = found.methods.front();
}

namespace {

constexpr double slow_turn_s = 0.5;  // chosen, not derived
// Speeds of the log at which delays within the band are looked at, alike many rows apart.
constexpr std::size_t speeds_judged = 9;

// Empty for a method without a linear filter at a constant speed.
std::optional<std::pair<Seconds, DegPerSec>> longest_of(const Contender& contender, Hertz sample_rate,
                                                        DegPerSec slowest, DegPerSec fastest) {
    if (contender.method->frozen == nullptr) return std::nullopt;
    if (contender.table == nullptr) {
        const LongestDelay longest = longest_delay(contender, sample_rate, {slowest, fastest});
        return std::pair(longest.delay, longest.speed);
    }
    std::pair<Seconds, DegPerSec> longest{Seconds(0.0), fastest};
    for (const Band& band : contender.table->bands()) {
        if (!(band.from < fastest) || band.to < slowest) continue;
        const Seconds delay = group_delay(band.cascade(), Hertz(0.0), SampledAt(sample_rate));
        if (delay > longest.first) longest = {delay, 0.5 * (band.from + band.to)};
    }
    return longest;
}

void hold_to(JudgedMethod& method, const Recommendation& found) {
    const RecommendationLimits& limits = found.limits;
    for (std::size_t i = 0; limits.min_attenuation_db && i < method.figures.attenuation.size(); ++i) {
        const OrderAttenuation& entry = method.figures.attenuation[i];
        const double limit = *limits.min_attenuation_db, db = entry.db.value_or(0.0);
        if (!found.asks_for(i) || db >= limit) continue;
        method.shortfalls.push_back(fmt::format("{:.1f} dB of {} (asked: {:g} dB)", db, entry.name(), limit));
        method.excess += (limit - db) / std::max(limit, 1.0);
    }
    const double start = method.figures.start_ratio.value_or(1.0);
    if (limits.max_start_ratio && start > *limits.max_start_ratio) {
        method.shortfalls.push_back(fmt::format("{:.1f} times the raw error at its start (asked: {:g})",
                                                start, *limits.max_start_ratio));
        method.excess += start - *limits.max_start_ratio;
    }
    if (!limits.max_delay || (method.delay && *method.delay <= *limits.max_delay)) return;
    const double limit_ms = 1e3 * limits.max_delay->value();
    if (!method.delay) {
        method.shortfalls.push_back(fmt::format("a delay that is not known (asked: {:g} ms)", limit_ms));
        method.excess += 1.0;
        return;
    }
    const double delay_ms = 1e3 * method.delay->value();
    method.shortfalls.push_back(fmt::format("{:.1f} ms of delay (asked: {:g} ms)", delay_ms, limit_ms));
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
    if (const auto longest =
            longest_of(contender, trace.sample_rate, DegPerSec(speeds.front()), DegPerSec(speeds.back())))
        std::tie(method.delay, method.delay_at) = *longest;
    if (contender.method->multiplications != nullptr)
        method.multiplications = contender.method->multiplications(contender.settings, contender.table.get());
    method.response = band_response(contender, trace.sample_rate, median, *found.band);
    const auto moving = std::upper_bound(speeds.begin(), speeds.end(), speeds.back() / 20.0);
    for (std::size_t i = 0; i < speeds_judged && moving != speeds.end(); ++i) {
        const auto apart = static_cast<std::size_t>(speeds.end() - moving - 1);
        const DegPerSec speed(moving[static_cast<std::ptrdiff_t>(apart * i / (speeds_judged - 1))]);
        const auto response = band_response(contender, trace.sample_rate, speed, *found.band);
        if (!response || !(response->longest_delay > *method.delay)) continue;
        method.delay = response->longest_delay;
        method.delay_at = speed;
    }
    return method;
}

// Of many orders one sentence: the first that was not searched, or the largest bound.
std::string without_ripple_text(const std::vector<RippleEstimate>& orders) {
    const bool all_searched =
        std::all_of(orders.begin(), orders.end(), std::mem_fn(&RippleEstimate::searched));
    if (orders.size() == 1 || (all_searched && orders.size() <= most_orders_named))
        return ripple_text(orders);
    const auto worse = [](const RippleEstimate& a, const RippleEstimate& b) {
        return std::pair(!a.searched(), a.detectable_nm) < std::pair(!b.searched(), b.detectable_nm);
    };
    const RippleEstimate& worst = *std::max_element(orders.begin(), orders.end(), worse);
    return fmt::format("{}, {} {} orders", ripple_text({&worst, 1}),
                       worst.searched() ? "the largest bound of" : "one of", orders.size());
}

bool better(const JudgedMethod& a, const JudgedMethod& b) {
    if (a.meets() != b.meets()) return a.meets();
    if (!a.meets() && a.excess != b.excess) return a.excess < b.excess;
    return a.error_nm() < b.error_nm();
}

std::string name_of(const MethodFigures& figures) {
    return figures.method.substr(0, figures.method.find(','));
}

}  // namespace

std::string_view recommendation_finding_name(RecommendationFinding finding) {
    constexpr std::array<std::string_view, 4> names{"recommended", "out-of-reach", "no-ripple",
                                                    "cannot-tell"};
    return names[static_cast<std::size_t>(finding)];
}

const JudgedMethod* Recommendation::runner_up() const {
    if (finding != RecommendationFinding::recommended || is_control(taken()->figures)) return nullptr;
    for (const JudgedMethod& method : methods) {
        if (!method.meets() || is_control(method.figures)) continue;
        if (method.error_nm() > larger_error * taken()->error_nm()) break;
        if (name_of(method.figures) != name_of(taken()->figures) && !traded(*taken(), method).empty())
            return &method;
    }
    return nullptr;
}

bool Recommendation::asks_for(std::size_t order) const {
    if (limits.every_order) return orders[order].present();
    double strongest_nm = 0.0;
    for (const RippleEstimate& one : orders)
        if (one.present()) strongest_nm = std::max(strongest_nm, one.amplitude_nm);
    return orders[order].present() && orders[order].amplitude_nm >= faint_share * strongest_nm;
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
    found.ratio = lines.ratio;
    found.orders = measured ? measured->ripple : std::move(ripple);
    if (std::none_of(found.orders.begin(), found.orders.end(), std::mem_fn(&RippleEstimate::present))) {
        const bool searched =
            std::all_of(found.orders.begin(), found.orders.end(), std::mem_fn(&RippleEstimate::searched));
        if (searched) found.finding = RecommendationFinding::no_ripple;
        found.why = without_ripple_text(found.orders);
        return found;
    }
    LogLevels levels = measured ? std::move(*measured)
                                : measure_on_log(contenders, log, &lines, found.orders,
                                                 BenchSignals{median_moving_speed(log.trace)}, band);
    found.windows = levels.lines.windows;
    found.raw_ripple_rms_nm = levels.raw_ripple_rms_nm;
    if (found.windows == 0 || !levels.band) {
        found.why =
            fmt::format("nothing can be judged on this log: {}",
                        found.windows == 0 ? levels.why_none : "no line of its ripple is known in it");
        return found;
    }
    found.band = levels.band;
    found.torque_rate_nm_s =
        torque_rate_nm_s(log.trace, GearRatio(lines.ratio.value() * lines.orders.front().value()));
    const std::vector<double> speeds = speeds_of(log.trace);
    Progress::current().begin("judging", "methods", contenders.size());
    for (std::size_t i = 0; i < contenders.size(); ++i, Progress::current().add(1)) {
        JudgedMethod method = judged(contenders[i], std::move(levels.methods[i]), log.trace, speeds, found);
        hold_to(method, found);
        found.methods.push_back(std::move(method));
    }
    std::stable_sort(found.methods.begin(), found.methods.end(), better);
    const auto fits = [](const JudgedMethod& one) { return one.meets() && !is_control(one.figures); };
    const bool any = std::any_of(found.methods.begin(), found.methods.end(), fits);
    found.finding = any ? RecommendationFinding::recommended : RecommendationFinding::out_of_reach;
    // What removes nothing is no answer to limits that no filter meets: the nearest filter is named.
    if (!any)
        std::stable_partition(found.methods.begin(), found.methods.end(),
                              [](const JudgedMethod& one) { return !is_control(one.figures); });
    return found;
}

}  // namespace ripplenotch
