// SPDX-License-Identifier: MIT
#include "analysis/verdict.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

namespace ripplenotch {
namespace {

constexpr double least_turns = 0.1;  // of output motion, before "nothing" means anything

/// "1", "1 and 2", "1, 2 and 4".
std::string listed(const std::vector<std::string>& words) {
    if (words.size() < 2) return words.empty() ? "" : words.front();
    std::string text = words.front();
    for (std::size_t i = 1; i + 1 < words.size(); ++i) text += ", " + words[i];
    return text + " and " + words.back();
}

std::string plural(std::size_t count, std::string_view noun) {
    return fmt::format("{} {}{}", count, noun, count == 1 ? "" : "s");
}

std::string speeds(double from, double to) {
    return to - from < 0.02 * to ? fmt::format("{:.3g} deg/s", to)
                                 : fmt::format("{:.3g} to {:.3g} deg/s", from, to);
}

bool from_motion(const Identification& result) {
    return result.evidence.find("order spectrum") != std::string::npos;
}

/// "from 3 steady stretches at 60 to 180 deg/s"
std::string basis(const Looked& looked, const Identification& result) {
    const bool no_stretch = !looked.steady || looked.steady->moving == 0;
    if (looked.motion && (from_motion(result) || no_stretch)) {
        return fmt::format("{} over {:.3g} output turns at {}", plural(looked.motion->sweeps, "sweep"),
                           looked.motion->turns,
                           speeds(looked.motion->slowest_deg_s, looked.motion->fastest_deg_s));
    }
    double slowest = 1e300, fastest = 0.0;
    for (const StretchLines& one : looked.steady->stretches) {
        if (one.stretch.rest) continue;
        slowest = std::min(slowest, std::abs(one.stretch.speed.value()));
        fastest = std::max(fastest, std::abs(one.stretch.speed.value()));
    }
    return fmt::format("{} at {}",
                       looked.steady->moving == 1 ? "1 steady stretch"
                                                  : fmt::format("{} steady stretches", looked.steady->moving),
                       speeds(slowest, fastest));
}

/// What the stretches at rest say.
std::string at_rest(const Looked& looked, const Identification& result) {
    if (!looked.steady || looked.steady->resting == 0) return "";
    std::vector<std::string> seen;
    for (const Line& line : result.lines) {
        const bool rests = std::any_of(line.by_speed.begin(), line.by_speed.end(),
                                       [](const AmplitudeAtSpeed& at) { return at.speed_deg_s == 0.0; });
        if (rests && line.hz) seen.push_back(fmt::format("{:.4g} Hz", *line.hz));
    }
    return seen.empty() ? "; no line at rest" : "; at rest " + listed(seen);
}

std::vector<const Line*> of_kind(const Identification& result, LineKind kind) {
    std::vector<const Line*> lines;
    for (const Line& line : result.lines) {
        if (line.kind == kind) lines.push_back(&line);
    }
    return lines;
}

std::string tones_too(const Identification& result) {
    std::vector<std::string> words;
    for (const Line* line : of_kind(result, LineKind::tone)) {
        const bool rests = std::any_of(line->by_speed.begin(), line->by_speed.end(),
                                       [](const AmplitudeAtSpeed& at) { return at.speed_deg_s == 0.0; });
        if (!rests && words.size() < 3)
            words.push_back(
                fmt::format("{:.4g} Hz{}", *line->hz, line->note.empty() ? "" : " (" + line->note + ")"));
    }
    return words.empty() ? "" : "; fixed tone at " + listed(words);
}

std::string with_ratio(const Looked& looked, const Identification& result) {
    std::vector<const Line*> lines;
    for (const Line& line : result.lines) {
        if (line.order) lines.push_back(&line);
    }
    std::sort(lines.begin(), lines.end(), [](const Line* a, const Line* b) { return *a->order < *b->order; });
    std::vector<std::string> orders, amplitudes;
    for (const Line* line : lines) {
        orders.push_back(fmt::format("{:.0f}", *line->order));
        amplitudes.push_back(fmt::format("{:.2f}", line->amplitude_nm));
    }
    std::string doubt;
    if (std::none_of(lines.begin(), lines.end(),
                     [](const Line* line) { return line->kind == LineKind::order; })) {
        doubt =
            "; one speed dominates, where a fixed tone would look the same: a log at another speed would "
            "tell";
    }
    const GearRatioFit& ratio = result.gear_ratio;
    const double half = 0.5 * (ratio.ci95_high - ratio.ci95_low);
    const int decimals = half < 0.005 ? 4 : half < 0.05 ? 3 : half < 0.5 ? 2 : 1;
    return fmt::format(
        "Ripple at order{} {} of the motor: gear ratio {:.{}f} +/- {:.{}f} (95 %), {} Nm zero to peak, from "
        "{}{}{}.",
        lines.size() == 1 ? "" : "s", listed(orders), *ratio.value, decimals, half, decimals,
        listed(amplitudes), basis(looked, result), at_rest(looked, result) + doubt, tones_too(result));
}

std::string candidates(const Identification& result) {
    std::vector<std::string> words;
    for (const RatioCandidate& candidate : result.gear_ratio.candidates) {
        if (words.size() < 4 && candidate.score > 0.0)
            words.push_back(fmt::format("{:.2f} ({})", candidate.value, candidate.reason));
    }
    return fmt::format("{}", fmt::join(words, ", "));
}

std::string without_ratio(const Looked& looked, const Identification& result,
                          const std::vector<const Line*>& orders) {
    std::vector<std::string> words;
    for (const Line* line : orders) {
        if (words.size() < 5)
            words.push_back(fmt::format("{:.5g} ({:.2g} Nm)", *line->order_output, line->amplitude_nm));
    }
    return fmt::format(
        "Ripple at output order{} {}, from {}{}{}; the gear ratio cannot be told from that: {}.",
        words.size() == 1 ? "" : "s", listed(words), basis(looked, result), at_rest(looked, result),
        tones_too(result), candidates(result));
}

std::string one_speed(const Looked& looked, const Identification& result,
                      const std::vector<const Line*>& unknown) {
    const Line& first = *unknown.front();
    std::string text =
        fmt::format("{} at {:.4g} Hz ({:.2g} Nm zero to peak), from {}",
                    unknown.size() == 1 ? "One line" : plural(unknown.size(), "line") + ", the strongest",
                    first.hz.value_or(0.0), first.amplitude_nm, basis(looked, result));
    if (first.order_output)
        text += fmt::format(": output order {:.5g} if it turns with the joint", *first.order_output);
    text +=
        "; one speed dominates, where an order and a fixed tone look alike, and a log at another speed would "
        "tell";
    if (!result.gear_ratio.candidates.empty())
        text += "; as an order it fits a gear ratio of " + candidates(result);
    return text + at_rest(looked, result) + tones_too(result) + ".";
}

/// Smallest amplitude that would have been reported, roughly: the floor times what the false-alarm rate asks.
double detectable(const Looked& looked) {
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

}  // namespace

void conclude(const Looked& looked, const IdentifyOptions& options, Identification& result) {
    const auto orders = of_kind(result, LineKind::order);
    const auto unknown = of_kind(result, LineKind::unknown);
    const bool moved_steadily = looked.steady && looked.steady->moving > 0;
    const bool moved = moved_steadily || (looked.motion && looked.motion->turns >= least_turns);
    if (looked.motion && looked.motion->sweeps_left_out > 0) {
        result.notes.push_back(fmt::format("the order spectrum used {} of {} sweeps, evenly chosen",
                                           looked.motion->sweeps,
                                           looked.motion->sweeps + looked.motion->sweeps_left_out));
    }
    if (looked.motion && !looked.motion->absolute_angle && looked.motion->sweeps > 0) {
        result.notes.push_back(
            "no position that agrees with the velocity: angle is integrated velocity, phases are not known");
    }
    if (result.gear_ratio.value) {
        result.verdict = with_ratio(looked, result);
        result.conclusive = std::any_of(orders.begin(), orders.end(),
                                        [](const Line* line) { return line->order.has_value(); });
    } else if (!orders.empty()) {
        result.verdict = without_ratio(looked, result, orders);
    } else if (!unknown.empty()) {
        result.verdict = one_speed(looked, result, unknown);
    } else if (moved) {
        result.verdict = fmt::format(
            "No ripple: no line above {:.2g} Nm turns with the joint, in {} ({:.2g} % false alarms){}{}.",
            detectable(looked), basis(looked, result), 100.0 * options.false_alarm, at_rest(looked, result),
            tones_too(result));
        result.conclusive = true;
    } else {
        const bool still = looked.steady && looked.steady->resting > 0;
        result.verdict = fmt::format(
            "Cannot tell: {}{}{}.",
            still ? "the joint is at rest" : "the joint moves too little or too briefly",
            at_rest(looked, result),
            still ? ""
                  : fmt::format("; needed are {:.2g} s at one speed, or {:.1f} output turns in all",
                                options.steady_for.value(), least_turns));
    }
}

}  // namespace ripplenotch
