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

constexpr double least_turns = 0.1;  // of output motion, before "nothing" means anything

bool any_of_kind(const Identification& result, LineKind kind) {
    return std::any_of(result.lines.begin(), result.lines.end(),
                       [kind](const Line& line) { return line.kind == kind; });
}

/// Smallest amplitude that would have been reported, roughly: the floor times what the false-alarm rate asks.
double detectable_nm(const Looked& looked) {
    double floor = 0.0;
    constexpr double threshold = 4.5;  // amplitude over floor of a line at the 1 % level in one stretch
    if (looked.motion && looked.motion->sweeps > 0) return looked.motion->detectable_nm;
    if (looked.steady) {
        for (const StretchLines& one : looked.steady->stretches) {
            if (!one.stretch.rest) floor = std::max(floor, one.floor_nm);
        }
    }
    return threshold * floor;
}

Grounds grounds_of(const Looked& looked, const IdentifyOptions& options, LineEvidence evidence) {
    Grounds grounds;
    grounds.false_alarm = options.false_alarm;
    grounds.steady_for = options.steady_for;
    grounds.needed_turns = least_turns;
    grounds.detectable_nm = detectable_nm(looked);
    if (looked.steady) {
        grounds.stretches = looked.steady->moving;
        grounds.rests = looked.steady->resting;
    }
    const bool sweeps_gave_lines = evidence == LineEvidence::sweeps || evidence == LineEvidence::both;
    grounds.from_sweeps = looked.motion && (sweeps_gave_lines || grounds.stretches == 0);
    if (looked.motion) {
        grounds.sweeps = looked.motion->sweeps;
        grounds.sweep_turns = looked.motion->turns;
    }
    if (grounds.from_sweeps) {
        grounds.slowest_deg_s = looked.motion->slowest_deg_s;
        grounds.fastest_deg_s = looked.motion->fastest_deg_s;
    } else if (grounds.stretches > 0) {
        grounds.slowest_deg_s = 1e300;
        for (const StretchLines& one : looked.steady->stretches) {
            if (one.stretch.rest) continue;
            const double speed = std::abs(one.stretch.speed.value());
            grounds.slowest_deg_s = std::min(grounds.slowest_deg_s, speed);
            grounds.fastest_deg_s = std::max(grounds.fastest_deg_s, speed);
        }
    }
    return grounds;
}

RippleFinding finding_in(const Identification& result) {
    if (result.gear_ratio.value) return RippleFinding::ratio;
    if (any_of_kind(result, LineKind::order)) return RippleFinding::orders;
    if (any_of_kind(result, LineKind::unknown)) return RippleFinding::one_speed;
    const Grounds& grounds = result.grounds;
    const bool moved = grounds.stretches > 0 || grounds.sweep_turns >= least_turns;
    return moved ? RippleFinding::nothing : RippleFinding::too_little;
}

/// A ratio from lines of one speed alone is the likeliest, and not settled; nor is one of several.
bool settled(const Identification& result) {
    const bool two_ratios =
        std::any_of(result.disagreements.begin(), result.disagreements.end(),
                    [](const Disagreement& one) { return one.about == Disagreement::About::ratio; });
    if (two_ratios) return false;
    if (result.finding == RippleFinding::nothing) return true;
    return result.finding == RippleFinding::ratio &&
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

/// Ripple at one or two speeds alone cannot tell what the velocity is off by.
std::string at_its_word(double slowest_deg_s) {
    constexpr double supposed_deg_s = 0.1;  // a usual offset of a velocity; by hand
    return fmt::format(
        "no position that agrees with the velocity, which is taken at its word: ripple at three speeds would "
        "tell what it is off by; {} deg/s would move the ratio by {:.1g} %, which is not in its interval",
        supposed_deg_s, 100.0 * supposed_deg_s / slowest_deg_s);
}

}  // namespace

void conclude(const Looked& looked, const IdentifyOptions& options, Identification& result) {
    if (looked.motion && looked.motion->sweeps_left_out > 0) {
        result.notes.push_back(fmt::format("the order spectrum used {} of {} sweeps, evenly chosen",
                                           looked.motion->sweeps,
                                           looked.motion->sweeps + looked.motion->sweeps_left_out));
    }
    if (looked.motion && !looked.motion->absolute_angle && looked.motion->sweeps > 0) {
        result.notes.push_back(
            "no position that agrees with the velocity: angle is integrated velocity, phases are not "
            "known, and " +
            of_velocity(result.velocity_error));
    }
    result.grounds = grounds_of(looked, options, result.evidence);
    if (looked.steady && result.evidence == LineEvidence::stretches) {
        if (looked.steady->offset)
            result.notes.push_back("no position that agrees with the velocity, and " +
                                   of_velocity(result.velocity_error));
        else if (looked.without_position && result.gear_ratio.value)
            result.notes.push_back(at_its_word(result.grounds.slowest_deg_s));
    }
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
