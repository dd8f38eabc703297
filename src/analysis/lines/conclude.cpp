// SPDX-License-Identifier: MIT
#include "analysis/lines/conclude.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "core/matrices/normal_errors.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

bool any_of_kind(const Identification& result, LineKind kind) {
    return std::any_of(result.lines.begin(), result.lines.end(),
                       [kind](const Line& line) { return line.kind == kind; });
}

Grounds grounds_of(const MotionLines& motion, const IdentifyOptions& options) {
    Grounds grounds;
    grounds.false_alarm = options.false_alarm;
    grounds.sweeps = motion.sweeps;
    grounds.rests = motion.rests;
    grounds.sweep_turns = motion.turns;
    grounds.slowest_deg_s = motion.slowest_deg_s;
    grounds.fastest_deg_s = motion.fastest_deg_s;
    return grounds;
}

RippleFinding finding_in(const Identification& result) {
    if (result.gear_ratio.value) return RippleFinding::ratio;
    if (any_of_kind(result, LineKind::order)) return RippleFinding::orders;
    if (any_of_kind(result, LineKind::unknown)) return RippleFinding::one_speed;
    return result.searched ? RippleFinding::nothing : RippleFinding::too_little;
}

/// A ratio from lines of one speed alone is the likeliest, and not settled; nor is one of several, or one
/// that cannot be distinguished from that of the other spline.
bool settled(const Identification& result) {
    const bool two_ratios =
        std::any_of(result.disagreements.begin(), result.disagreements.end(),
                    [](const Disagreement& one) { return one.about == Disagreement::About::ratio; });
    if (two_ratios) return false;
    if (result.finding == RippleFinding::nothing) return true;
    return result.finding == RippleFinding::ratio && !result.gear_ratio.coarse &&
           std::any_of(result.lines.begin(), result.lines.end(), [](const Line& line) {
               return line.kind == LineKind::order && line.order.has_value();
           });
}

/// With as many decimals as the error has one digit; "0 within 0.02 deg/s" where the value is no larger.
std::string told(double value, double error, std::string_view unit, std::string_view below,
                 std::string_view above) {
    const double reach = normal_95_errors * error;
    const int decimals = std::max(0, -static_cast<int>(std::floor(portable::log10(error))));
    if (std::abs(value) <= reach) return fmt::format("0 within {:.{}f} {}", reach, decimals, unit);
    return fmt::format("{:.{}f} +/- {:.{}f} {} too {}", std::abs(value), decimals, error, decimals, unit,
                       value < 0.0 ? below : above);
}

std::string of_velocity(const std::optional<VelocityError>& error) {
    if (!error)
        return "what an offset, a filter or a delay of the velocity does to the ratio is not in its interval";
    std::string text = "the ripple tells what the velocity is off by: " +
                       told(error->offset.value(), error->offset_error.value(), "deg/s", "low", "high");
    if (error->delay_told)
        text +=
            ", " + told(1e3 * error->delay.value(), 1e3 * error->delay_error.value(), "ms", "early", "late");
    return text + "; that is taken off, and its error is in the ratio's interval";
}

}  // namespace

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
    result.grounds = grounds_of(motion, options);
    result.searched = motion.searched;
    settle(result);
}

void settle(Identification& result) {
    result.finding = finding_in(result);
    result.conclusive = settled(result);
    result.verdict = verdict_sentence(result);
}

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

}  // namespace ripplenotch
