// SPDX-License-Identifier: MIT
#include "cli/design/frontier_text.hpp"

#include <fmt/format.h>

#include <vector>

#include "cli/text_table.hpp"
#include "ripplenotch/core/how_many.hpp"
#include "ripplenotch/core/number.hpp"

namespace ripplenotch {
namespace {

std::string four(double value) { return fmt::format("{:.4g}", value); }

// A delay turns a loop's phase by 360 degrees times delay times crossover; so much is often spared for it.
constexpr double spared_deg = 30.0;

std::string crossover_text(Seconds delay) {
    return delay.value() > 0.0 ? fmt::format("{:.2g}", spared_deg / 360.0 / delay.value()) : "-";
}

std::string q_range(const TradePoint& point) {
    if (point.least_q == point.largest_q) return fmt::format("{:.3g}", point.least_q);
    return fmt::format("{:.3g}-{:.3g}", point.least_q, point.largest_q);
}

std::string heading(const Frontier& frontier) {
    const DesignGoal& goal = frontier.goal;
    std::string limits;
    if (goal.min_attenuation_db) limits += fmt::format(", at least {} dB", four(*goal.min_attenuation_db));
    if (goal.max_delay) limits += fmt::format(", at most {} ms", four(1e3 * goal.max_delay->value()));
    if (!goal.min_attenuation_db && !goal.max_delay)
        limits += fmt::format(", up to {} bands", goal.most_bands.value_or(frontier_bands));
    const std::string doubt =
        frontier.spec.ratio_error > 0.0
            ? fmt::format(" (within {} %)", fmt::format("{:.2g}", 100.0 * frontier.spec.ratio_error))
            : "";
    return fmt::format("What a table for gear ratio {}{} can hold from {} to {} deg/s at {} Hz{}.\n\n",
                       fmt::format("{:.6g}", frontier.spec.gear_ratio.value()), doubt,
                       four(goal.from.value()), four(goal.to.value()),
                       fmt::format("{:.6g}", frontier.spec.sample_rate.value()), limits);
}

}  // namespace

std::string slowest_sentence(Seconds delay, DegPerSec slowest) {
    return fmt::format("Below {} deg/s no notch of Q 5 or less is within {} ms.", four(slowest.value()),
                       four(1e3 * delay.value()));
}

std::string recommended_sentence(const Frontier& frontier) {
    const TradePoint& chosen = frontier.points[frontier.recommended];
    return fmt::format("Recommended: {:.1f} dB with {:.1f} ms in {}: {}.", chosen.attenuation_db,
                       1e3 * chosen.delay.value(), how_many(chosen.bands, "band"), frontier.reason);
}

std::string crossover_sentence(Seconds delay, std::string_view aside) {
    return fmt::format(
        "At a crossover of {} Hz this delay costs a loop {:g} deg of phase{}; for a faster loop give "
        "--max-delay.",
        crossover_text(delay), spared_deg, aside);
}

std::string frontier_to_text(const Frontier& frontier) {
    std::vector<std::vector<std::string>> rows = {
        {"attenuation", "delay", "loop to", "bands", "Q", "settles", "overshoot", ""},
        {"dB held", "ms", "Hz", "", "", fmt::format("ms to {} %", four(frontier.spec.settle_band_percent)),
         "%", ""}};
    for (std::size_t i = 0; i < frontier.points.size(); ++i) {
        const TradePoint& point = frontier.points[i];
        rows.push_back({fmt::format("{:.1f}", point.attenuation_db),
                        fmt::format("{:.1f}", 1e3 * point.delay.value()), crossover_text(point.delay),
                        std::to_string(point.bands), q_range(point),
                        fmt::format("{:.0f}", 1e3 * point.settle.value()),
                        fmt::format("{:.1f}", point.overshoot_percent),
                        i == frontier.recommended ? "<- recommended" : ""});
    }
    const TradePoint& chosen = frontier.points[frontier.recommended];
    std::string text = heading(frontier) + text_table(rows, "r");
    text += "\n" + recommended_sentence(frontier) + "\n";
    text += crossover_sentence(chosen.delay, " (\"loop to\")") + "\n";
    if (frontier.slowest) text += slowest_sentence(chosen.delay, *frontier.slowest) + "\n";
    return text;
}

}  // namespace ripplenotch
