// SPDX-License-Identifier: MIT
#include "ripplenotch/analysis/identification.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "analysis/lines/encoder.hpp"
#include "core/matrices/least_squares.hpp"
#include "ripplenotch/analysis/line_search.hpp"
#include "ripplenotch/analysis/line_test.hpp"
#include "ripplenotch/analysis/ripple_estimate.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {

namespace {

// Names in an identification, and values derived from it.

template <class Value>
using Named = std::pair<Value, std::string_view>;

constexpr std::array findings{Named<RippleFinding>{RippleFinding::ratio, "ratio"},
                              Named<RippleFinding>{RippleFinding::orders, "orders"},
                              Named<RippleFinding>{RippleFinding::one_speed, "one speed"},
                              Named<RippleFinding>{RippleFinding::nothing, "nothing"},
                              Named<RippleFinding>{RippleFinding::too_noisy, "too noisy"},
                              Named<RippleFinding>{RippleFinding::too_little, "too little motion"}};
constexpr std::array doubt_reasons{Named<DoubtReason>{DoubtReason::clock, "clock"},
                                   Named<DoubtReason>{DoubtReason::unit, "unit"}};
constexpr std::array abouts{Named<Disagreement::About>{Disagreement::About::ratio, "gear ratio"},
                            Named<Disagreement::About>{Disagreement::About::amplitude, "amplitude"}};
constexpr std::array line_kinds{Named<LineKind>{LineKind::order, "order"},
                                Named<LineKind>{LineKind::tone, "tone"},
                                Named<LineKind>{LineKind::unknown, "unknown"}};

template <class Table, class Value>
std::string_view name_in(const Table& table, Value value) {
    for (const auto& [one, name] : table) {
        if (one == value) return name;
    }
    return "";
}

}  // namespace

std::string_view finding_name(RippleFinding finding) { return name_in(findings, finding); }

std::string_view doubt_name(DoubtReason reason) { return name_in(doubt_reasons, reason); }

std::string_view about_name(Disagreement::About about) { return name_in(abouts, about); }

std::string_view line_kind_name(LineKind kind) { return name_in(line_kinds, kind); }

std::optional<SeenFrequencies> seen_frequencies(const Line& line) {
    if (line.hz) return SeenFrequencies{*line.hz, *line.hz};
    if (line.by_speed.empty()) return std::nullopt;
    const auto [lowest, highest] =
        std::minmax_element(line.by_speed.begin(), line.by_speed.end(),
                            [](const AmplitudeAtSpeed& a, const AmplitudeAtSpeed& b) { return a.hz < b.hz; });
    return SeenFrequencies{lowest->hz, highest->hz};
}

std::optional<double> motor_order(const Line& line) {
    const bool follows = line.kind == LineKind::order || line.kind == LineKind::unknown;
    return follows ? line.order : std::nullopt;
}

std::optional<GearAccount> found_gear(const Identification& found) {
    if (!found.gear_ratio.value) return std::nullopt;
    std::vector<Order> orders;
    for (const Line& line : found.lines) {
        if (const auto order = motor_order(line)) orders.emplace_back(*order);
    }
    std::sort(orders.begin(), orders.end());
    orders.erase(std::unique(orders.begin(), orders.end()), orders.end());
    return GearAccount{GearRatio(*found.gear_ratio.value), std::move(orders), {}, {}, "found in the log"};
}

std::optional<double> motor_amplitude(const Identification& found, const std::string& motor) {
    double largest = 0.0;
    if (found.joint == motor) {
        for (const Line& line : found.lines)
            if (line.order_output) largest = std::max(largest, line.amplitude_nm);
    }
    for (const OtherMotorRipple& other : found.other_motors) {
        if (other.joint != motor || !other.doubt.empty()) continue;
        for (const OtherMotorRipple::AtOrder& at : other.orders)
            if (at.found) largest = std::max(largest, at.amplitude_nm);
    }
    return largest > 0.0 ? std::optional(largest) : std::nullopt;
}

std::vector<std::string> motors_in_matrix(std::span<const Identification> found) {
    std::vector<std::string> motors;
    if (found.size() < 2) return motors;
    const auto add = [&motors](const std::string& joint) {
        if (std::find(motors.begin(), motors.end(), joint) == motors.end()) motors.push_back(joint);
    };
    const auto looked_for = [&found](const std::string& joint) {
        return std::any_of(found.begin(), found.end(), [&](const Identification& one) {
            return std::any_of(one.other_motors.begin(), one.other_motors.end(),
                               [&](const OtherMotorRipple& motor) { return motor.joint == joint; });
        });
    };
    for (const Identification& one : found)
        if (looked_for(one.joint)) add(one.joint);
    for (const Identification& one : found)
        for (const OtherMotorRipple& motor : one.other_motors) add(motor.joint);
    return motors;
}

namespace {

bool any_of_kind(const Identification& result, LineKind kind) {
    return std::any_of(result.lines.begin(), result.lines.end(),
                       [kind](const Line& line) { return line.kind == kind; });
}

RippleFinding finding_in(const Identification& result) {
    if (result.gear_ratio.value && !result.gear_ratio.contradicted) return RippleFinding::ratio;
    if (any_of_kind(result, LineKind::order)) return RippleFinding::orders;
    if (any_of_kind(result, LineKind::unknown)) return RippleFinding::one_speed;
    if (!result.searched) return RippleFinding::too_little;
    return result.searched->detectable_nm > result.searched->deviation_nm ? RippleFinding::too_noisy
                                                                          : RippleFinding::nothing;
}

/// A ratio from lines of one speed alone is the likeliest, but not settled; nor is one of several.
bool settled(const Identification& result) {
    const bool two_ratios =
        std::any_of(result.disagreements.begin(), result.disagreements.end(),
                    [](const Disagreement& one) { return one.about == Disagreement::About::ratio; });
    if (two_ratios) return false;
    if (result.finding == RippleFinding::nothing) return true;
    const auto& ratios = result.gear_ratio.candidates;
    return result.finding == RippleFinding::ratio && ratios.front().score > conclusive_probability &&
           std::any_of(result.lines.begin(), result.lines.end(), [](const Line& line) {
               return line.kind == LineKind::order && line.order.has_value();
           });
}

/// With as many decimals as the error has one digit; "0 within 0.02 deg/s" where the value is no larger.
std::string told(double value, double error, std::string_view unit, std::string_view below,
                 std::string_view above) {
    const double reach = normal_95_errors * error;
    const int decimals = decimals_of(error, 1);
    if (std::abs(value) <= reach) return fmt::format("0 within {:.{}f} {}", reach, decimals, unit);
    return fmt::format("{:.{}f} +/- {:.{}f} {} too {}", std::abs(value), decimals, error, decimals, unit,
                       value < 0.0 ? below : above);
}

std::string of_velocity(const std::optional<VelocityError>& error) {
    if (!error) return "the ratio's interval does not include an offset of the velocity";
    return "velocity error estimated from the ripple: " +
           told(error->offset.value(), error->offset_error.value(), "deg/s", "low", "high") +
           "; it is corrected, and its uncertainty is included in the ratio's interval";
}

/// Finding, conclusive and verdict once more, after something was added.
void settle(Identification& result) {
    result.finding = finding_in(result);
    result.conclusive = settled(result);
    result.verdict = verdict_sentence(result);
}

/// Writes finding, grounds, notes, conclusive and verdict from the lines and the ratio already in `result`.
void conclude(const MotionLines& motion, const IdentifyOptions& options, Identification& result) {
    if (motion.sweeps_left_out > 0) {
        result.notes.push_back(fmt::format("the order spectrum used {} of {} sweeps, evenly chosen",
                                           motion.sweeps, motion.sweeps + motion.sweeps_left_out));
    }
    if (!motion.absolute_angle && motion.sweeps > 0) {
        result.notes.push_back(
            "no position that agrees with the velocity: angle is integrated velocity, phases are not "
            "known, and " +
            of_velocity(result.velocity_error));
    }
    result.grounds = {motion.sweeps,        motion.rests,         motion.turns,
                      motion.slowest_deg_s, motion.fastest_deg_s, options.false_alarm};
    result.searched = motion.searched;
    settle(result);
}

}  // namespace

void cast_doubt(Identification& found, Doubt doubt) {
    for (Line& line : found.lines) {
        if (line.kind == LineKind::tone) continue;
        Line doubted;
        doubted.hz = line.hz;
        doubted.amplitude_nm = line.amplitude_nm;
        doubted.snr = line.snr;
        doubted.speed_from_deg_s = line.speed_from_deg_s;
        doubted.speed_to_deg_s = line.speed_to_deg_s;
        doubted.by_speed = std::move(line.by_speed);
        line = std::move(doubted);
    }
    found.gear_ratio = {};
    found.disagreements.clear();
    if (std::find(found.doubts.begin(), found.doubts.end(), doubt) == found.doubts.end())
        found.doubts.push_back(std::move(doubt));
    found.conclusive = false;
    found.verdict = verdict_sentence(found);
}

namespace {

/// A line as it is reported, and as the gear ratio sees it when it may turn with the joint.
struct Reported {
    Line line = {};
    std::optional<OrderLine> order = {};
};

/// Which multiple of the mains frequency a tone is; 0: none.
double mains_multiple(const Line& line, double mains_hz) {
    constexpr double tolerance = 0.004;  // mains keep within 1 %, nearly always within a fifth of that
    if (line.kind != LineKind::tone || !line.hz) return 0.0;
    const double n = std::round(*line.hz / mains_hz);
    return n <= 6.0 && std::abs(*line.hz - n * mains_hz) <= tolerance * n * mains_hz ? n : 0.0;
}

/// Notes at tones that they are the mains frequency or a multiple of it: 50 or 60 Hz, whichever more are.
void name_mains(std::span<Line> lines) {
    const auto count = [&](double hz) {
        return std::count_if(lines.begin(), lines.end(),
                             [hz](const Line& line) { return mains_multiple(line, hz) > 0.0; });
    };
    const double hz = count(60.0) > count(50.0) ? 60.0 : 50.0;
    for (Line& line : lines)
        if (const double n = mains_multiple(line, hz); n > 0.0)
            line.note = fmt::format("{}mains {:.0f} Hz", n > 1.0 ? fmt::format("{:.0f} times ", n) : "", hz);
}

// Line number `source` of a motion.
Reported from_motion(const MotionLines& motion, std::size_t source) {
    const MotionLine& found = motion.lines[source];
    Reported reported;
    Line& line = reported.line;
    line.kind = found.kind;
    line.amplitude_nm = found.amplitude_nm;
    line.snr = found.snr;
    line.by_speed = found.by_speed;
    line.speed_from_deg_s = motion.slowest_deg_s;
    line.speed_to_deg_s = motion.fastest_deg_s;
    if (found.kind != LineKind::order && found.hz > 0.0) line.hz = found.hz;
    const bool tone = found.kind == LineKind::tone;
    if (!tone) {
        line.order_output = found.order_output;
        line.order_output_stderr =
            portable::hypot(found.order_stderr, found.order_output * motion.order_share_error);
        reported.order = OrderLine{found.order_output,
                                   found.order_stderr,
                                   found.snr,
                                   found.amplitude_nm,
                                   0.5 * (motion.slowest_deg_s + motion.fastest_deg_s),
                                   motion.order_share_error,
                                   static_cast<double>(std::max<std::size_t>(1, found.by_speed.size()))};
    }
    if (found.phase_deg) {
        line.phase_deg = *found.phase_deg;
        line.phase_known = true;
    }
    if (found.kind == LineKind::unknown)
        line.note = "the speed varies too little to distinguish an order from a tone";
    return reported;
}

/// Of a stated ratio, from where on its lines are asked for.
constexpr double stated_part = 0.9;

/// Fits the ratio to what may be orders and writes each line's order per motor turn.
void add_ratio(std::vector<Reported>& reported, const MotionLines& motion, const IdentifyOptions& options,
               Identification& result) {
    RatioQuestion question{options.hint, options.hinted_orders, motion.resolution_orders};
    question.lowest = std::max(motion.lowest_order, 1.0);
    // The shares of orders are of lines up to question.highest, which stands where nothing is stated.
    const bool stated = options.hint || !options.hinted_orders.empty();
    question.highest = stated ? motion.highest_order : std::min(question.highest, motion.highest_order);
    question.highest = std::max(question.highest, 2.0 * question.lowest);
    if (motion.searched && !motion.searched->bounds.empty())
        question.detectable_nm = [&bounds = motion.searched->bounds](double order) {
            const auto next = std::find_if(bounds.begin() + 1, bounds.end(),
                                           [order](const auto& bound) { return bound.from_order > order; });
            return std::prev(next)->detectable_nm;
        };
    std::vector<OrderLine> orders;
    std::vector<std::size_t> owner;
    for (std::size_t i = 0; i < reported.size(); ++i) {
        if (!reported[i].order) continue;
        const double order = reported[i].order->order_output;
        if (order < question.lowest || order > question.highest) continue;
        orders.push_back(*reported[i].order);
        owner.push_back(i);
    }
    GearRatioResult ratio = fit_gear_ratio(orders, question);
    result.gear_ratio = std::move(ratio.fit);
    for (std::string& note : ratio.notes) result.notes.push_back(std::move(note));
    for (std::size_t i = 0; i < owner.size(); ++i) {
        if (const auto n = ratio.order_of_line[i]) reported[owner[i]].line.order = *n;
    }
}

/// Mean over the logs, weighed by their durations. Throws DataError for a log with too few samples.
Hertz mean_sample_rate(std::span<const TraceView> logs) {
    double seconds = 0.0, samples = 0.0;
    for (const TraceView& log : logs) {
        if (log.size() < fewest_identify_samples) {
            raise<DataError>("a log has {} samples, at least {} are needed to look for lines", log.size(),
                             fewest_identify_samples);
        }
        seconds += static_cast<double>(log.size()) / log.sample_rate.value();
        samples += static_cast<double>(log.size());
    }
    return Hertz(seconds > 0.0 ? samples / seconds : 0.0);
}

/// Where the gear is known, the amplitudes of lines that turn with the joint are those of estimate_ripple. A
/// line that its windows hardly show, or do not separate from the next, keeps what the sums over whole sweeps
/// give.
void estimate_amplitudes(std::span<const TraceView> logs, Identification& result) {
    if (!result.gear_ratio.value) return;
    const double ratio = *result.gear_ratio.value;
    std::vector<Line*> turning;
    std::vector<Order> orders;
    for (Line& line : result.lines) {
        if (line.kind == LineKind::tone || !line.order_output) continue;
        turning.push_back(&line);
        orders.emplace_back(*line.order_output / ratio);
    }
    const std::vector<RippleEstimate> found = estimate_ripple(logs, GearRatio(ratio), orders);
    for (std::size_t i = 0; i < found.size(); ++i)
        if (found[i].amplitude_nm > normal_95_errors * found[i].standard_error_nm)
            turning[i]->amplitude_nm = found[i].amplitude_nm;
}

/// The result of all logs together, without testing whether each agrees.
Identification identify_together(std::span<const TraceView> logs, const IdentifyOptions& options) {
    Identification result;
    result.sample_rate = mean_sample_rate(logs);
    MotionLinesOptions search;
    search.false_alarm = options.false_alarm;
    search.highest_order = options.highest_order;
    if (options.hint)
        search.lowest_order = std::min(search.lowest_order, stated_part * options.hint->value());
    MotionLines motion = find_motion_lines(logs, search);
    if (const std::size_t of_steps = take_off_encoder_lines(logs, search.sweeps, motion.lines); of_steps > 0)
        result.notes.push_back(fmt::format("{} made by the steps of the position's encoder, not listed",
                                           how_many(of_steps, "line")));
    std::vector<Reported> reported;
    for (std::size_t i = 0; i < motion.lines.size(); ++i) reported.push_back(from_motion(motion, i));
    result.velocity_error = motion.velocity_error;
    for (const TraceView& log : logs)
        result.velocity_noise = std::max(result.velocity_noise, velocity_noise(log));
    if (motion.sweeps > 0) result.evidence = "order spectrum";
    add_ratio(reported, motion, options, result);
    for (Reported& r : reported) {
        result.lines.push_back(std::move(r.line));
    }
    name_mains(result.lines);
    estimate_amplitudes(logs, result);
    std::stable_sort(result.lines.begin(), result.lines.end(),
                     [](const Line& a, const Line& b) { return a.amplitude_nm > b.amplitude_nm; });
    conclude(motion, options, result);
    return result;
}

// Consistency of the recordings of one joint.

constexpr double least_spread = 0.1;  // scatter of amplitudes as a share of their mean
// Scatter of amplitudes from run to run of a joint that has not changed.
constexpr double usual_scatter = 0.03;
constexpr double like_speed_share = 0.05;                          // chosen, not derived
constexpr double like_order_share = 0.01, like_ratio_share = 0.1;  // chosen, not derived
constexpr double least_chance = 0.001;         // recordings that agree differ by as much less often than this
constexpr std::size_t fewest_for_scatter = 3;  // recordings: fewer have no median

using Value = Disagreement::Value;

/// The chance that values which are one differ by as much of their errors.
double chance_of_alike(const std::vector<Value>& values) {
    double top = 0.0, bottom = 0.0, misfit = 0.0;
    for (const Value& one : values) {
        top += one.value / (one.error * one.error);
        bottom += 1.0 / (one.error * one.error);
    }
    for (const Value& one : values) {
        const double off = (one.value - top / bottom) / one.error;
        misfit += off * off;
    }
    return chi_square_chance(misfit, static_cast<double>(values.size()) - 1.0);
}

/// Signed speeds.
bool like_speed(double speed, double other) {
    return std::abs(speed - other) <= like_speed_share * std::abs(other);
}

const Line* same_line(const Identification& one, double order_output) {
    const Line* nearest = nullptr;
    for (const Line& line : one.lines) {
        if (!line.order_output || line.kind == LineKind::tone) continue;
        const double off = std::abs(*line.order_output - order_output);
        if (off > like_order_share * order_output) continue;
        if (nearest == nullptr || off < std::abs(*nearest->order_output - order_output)) nearest = &line;
    }
    return nearest;
}

/// Mean amplitude of a line near a speed, signed, with its error: of noise, or of the scatter where there are
/// enough.
std::optional<Value> amplitude_at(std::size_t recording, const Line& line, double speed_deg_s) {
    double sum = 0.0, noise = 0.0, count = 0.0, square = 0.0;
    for (const AmplitudeAtSpeed& at : line.by_speed) {
        if (!like_speed(at.speed_deg_s, speed_deg_s)) continue;
        // Half of the noise power near a line is in quadrature and changes its phase.
        const double error = at.amplitude_nm / std::max(at.snr, 1.0) / std::sqrt(2.0);
        sum += at.amplitude_nm;
        square += at.amplitude_nm * at.amplitude_nm;
        noise += error * error;
        count += 1.0;
    }
    if (count == 0.0) return std::nullopt;
    const double mean = sum / count;
    double variance = noise / (count * count);
    if (count >= static_cast<double>(fewest_for_scatter))
        variance = std::max(variance, (square / count - mean * mean) / (count - 1.0));
    return Value{recording, mean, portable::hypot(std::sqrt(std::max(variance, 0.0)), usual_scatter * mean)};
}

/// The speeds at which most recordings show the line, and what each of these shows there.
std::vector<Value> amplitudes_at_like_speed(std::span<const Identification> each, double order_output) {
    std::vector<Value> best;
    for (const Identification& one : each) {
        const Line* line = same_line(one, order_output);
        if (line == nullptr) continue;
        for (const AmplitudeAtSpeed& at : line->by_speed) {
            std::vector<Value> values;
            for (std::size_t i = 0; i < each.size(); ++i) {
                const Line* other = same_line(each[i], order_output);
                if (other == nullptr) continue;
                if (const auto value = amplitude_at(i, *other, at.speed_deg_s)) values.push_back(*value);
            }
            if (values.size() > best.size()) best = std::move(values);
        }
    }
    return best;
}

std::optional<Disagreement> about_amplitude(const Line& line, std::span<const Identification> each) {
    std::vector<Value> values = amplitudes_at_like_speed(each, *line.order_output);
    if (values.size() < 2) return std::nullopt;
    const auto by_value = [](const Value& a, const Value& b) { return a.value < b.value; };
    const auto [least, most] = std::minmax_element(values.begin(), values.end(), by_value);
    const double chance = chance_of_alike(values);
    if (chance > least_chance || most->value < (1.0 + least_spread) * least->value) return std::nullopt;
    return Disagreement{Disagreement::About::amplitude, line.order, line.order_output, std::move(values),
                        chance};
}

/// Compares ratios near the common one only: half of it is another interpretation of the same lines.
std::optional<Disagreement> about_ratio(const Identification& together,
                                        std::span<const Identification> each) {
    std::vector<Value> values;
    if (!together.gear_ratio.value) return std::nullopt;
    const double common = *together.gear_ratio.value;
    for (std::size_t i = 0; i < each.size(); ++i) {
        const GearRatioFit& fit = each[i].gear_ratio;
        if (fit.value && std::abs(*fit.value - common) < like_ratio_share * common)
            values.push_back({i, *fit.value, std::max(0.25 * (fit.ci95_high - fit.ci95_low), 1e-9)});
    }
    if (values.size() < 2) return std::nullopt;
    const double chance = chance_of_alike(values);
    if (chance > least_chance) return std::nullopt;
    return Disagreement{Disagreement::About::ratio, {}, {}, std::move(values), chance};
}

/// Each recording's own result, compared with the lines and the ratio of all of them. Amplitudes are compared
/// at similar speeds only, for ripple depends on speed; they disagree when chance makes as much of their
/// errors less than once in a thousand cases and the largest is a tenth above the smallest or more. Ratios
/// disagree by the same chance. Empty for fewer than two recordings.
std::vector<Disagreement> disagreements(const Identification& together,
                                        std::span<const Identification> each) {
    std::vector<Disagreement> found;
    if (each.size() < 2) return found;
    if (auto ratio = about_ratio(together, each)) found.push_back(std::move(*ratio));
    for (const Line& line : together.lines) {
        if (!line.order_output || line.kind == LineKind::tone) continue;
        if (auto amplitude = about_amplitude(line, each)) found.push_back(std::move(*amplitude));
    }
    return found;
}

}  // namespace

Identification identify(std::span<const TraceView> logs, const IdentifyOptions& options) {
    Identification together = identify_together(logs, options);
    const bool ripple = std::any_of(together.lines.begin(), together.lines.end(), [](const Line& line) {
        return line.kind != LineKind::tone && line.order_output;
    });
    if (ripple && logs.size() > 1) {
        std::vector<Identification> each;
        for (const TraceView& log : logs) each.push_back(identify_together({&log, 1}, options));
        together.disagreements = disagreements(together, each);
        settle(together);
    }
    for (const Doubt& doubt : options.doubts) cast_doubt(together, doubt);
    return together;
}

}  // namespace ripplenotch
