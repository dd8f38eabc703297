// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "model/effects.hpp"
#include "ripplenotch/model/fit.hpp"

namespace ripplenotch {
namespace {

constexpr Parameter parameters[] = {
    {.name = "limit_nm",
     .unit = "Nm",
     .help = "largest torque that is logged; at the upper bound there is no limit",
     .neutral = 1e6,
     .start = 2.0,
     .lower = 0.0,
     .upper = 1e6},
};

constexpr LookAlike look_alikes[] = {
    {"rest on a coarse quantization", "the torque rests at its extreme",
     "a finer log; clipped samples lie at both ends of the range"},
};

void apply(const Situation&, std::span<const double> values, std::span<double> torque_nm) {
    for (std::size_t k = 0; k < torque_nm.size(); ++k)
        torque_nm[k] = std::clamp(torque_nm[k], -values[0], values[0]);
}

// The most samples in a row of one value that is no end of the range.
std::size_t longest_hold(std::span<const double> torque_nm, double low_nm, double high_nm) {
    std::size_t longest = 1, here = 1;
    for (std::size_t k = 1; k < torque_nm.size(); ++k) {
        const bool held = torque_nm[k] == torque_nm[k - 1] && torque_nm[k] > low_nm && torque_nm[k] < high_nm;
        here = held ? here + 1 : 1;
        longest = std::max(longest, here);
    }
    return longest;
}

// Number of samples at an end of the range, without those that the recorder only repeats (it holds up to
// `longest` samples elsewhere). Where it holds by chance, each further sample is less likely by the same
// factor: none is held twice as long as all others.
std::size_t counted_once(std::span<const std::size_t> at, std::size_t longest) {
    const std::size_t held = longest > 1 ? 2 * longest : 1;
    std::size_t counted = 0;
    for (std::size_t first = 0, end = 0; first < at.size(); first = end) {
        end = first + 1;
        while (end < at.size() && at[end] == at[end - 1] + 1) ++end;
        counted += end - first > held ? end - first : 1;
    }
    return counted;
}

// Samples at an end of the log's range; none where the torque only came to its extreme.
std::vector<std::size_t> clipped_at(const LoggedTorque& log, double rail_nm, std::size_t longest,
                                    const FaultRules& rules) {
    std::vector<std::size_t> at;
    std::size_t next = 0;  // samples on the level before the last
    for (std::size_t k = 0; k < log.torque_nm.size(); ++k) {
        const double off = std::abs(log.torque_nm[k] - rail_nm);
        if (off <= 1e-9 * std::abs(rail_nm))
            at.push_back(k);
        else if (log.step_nm > 0.0 && off < rules.next_level_steps * log.step_nm)
            ++next;
    }
    // On whole steps the extreme is held by chance, but by fewer samples than the level below it.
    const bool by_chance = log.step_nm > 0.0 &&
                           static_cast<double>(at.size()) < rules.clipped_of_next * static_cast<double>(next);
    if (counted_once(at, longest) < rules.fewest_clipped || by_chance) at.clear();
    return at;
}

std::optional<DetectedFault> detect(const LoggedTorque& log, const FaultRules& rules) {
    const auto [low, high] = std::minmax_element(log.torque_nm.begin(), log.torque_nm.end());
    // Whole steps hold a torque as well.
    const std::size_t longest = log.step_nm > 0.0 ? 1 : longest_hold(log.torque_nm, *low, *high);
    DetectedFault fault;
    double limit_nm = 0.0;
    for (const double rail_nm : {*low, *high}) {
        const std::vector<std::size_t> at = clipped_at(log, rail_nm, longest, rules);
        if (at.empty()) continue;
        limit_nm = std::max(limit_nm, std::abs(rail_nm));
        fault.spoiled.insert(fault.spoiled.end(), at.begin(), at.end());
    }
    if (fault.spoiled.empty()) return std::nullopt;
    std::sort(fault.spoiled.begin(), fault.spoiled.end());
    fault.values = {limit_nm};
    fault.words = fmt::format("{} samples stand at exactly {:.3g} Nm, the end of the log's range",
                              fault.spoiled.size(), limit_nm);
    return fault;
}

}  // namespace

const Effect effects::saturation{
    .name = "saturation",
    .summary = "the sensor or its converter clips",
    .equation = "logged torque = torque, or -limit_nm or limit_nm where it is beyond",
    .symptom = "runs of samples at exactly the largest value of the log",
    .look_alikes = look_alikes,
    .source = "the range of an amplifier",
    .side = Side::converter,
    .domain = Domain::time,
    .parameters = parameters,
    .linear_in_torque = false,
    .range_limit = 0,
    .apply = apply,
    .detect = detect,
};

}  // namespace ripplenotch
