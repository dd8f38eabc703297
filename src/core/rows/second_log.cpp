// SPDX-License-Identifier: MIT
#include "core/rows/second_log.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <vector>

namespace ripplenotch {
namespace {

// A direction, rests, or slow motion that has less of the log is asked for.
constexpr double least_part = 0.05;
// Of the fastest speed: below it is standstill, up to there motion is slow, where kinds of friction part.
constexpr double standstill_share = 0.01, slow_share = 0.2;
constexpr double smallest_travel_deg = 360.0;  // a smaller travel does not tell effects of the position apart
constexpr std::size_t most_rivals = 6;         // with all that can be asked for that is 30 words

std::string list_of(const std::vector<std::string_view>& items) {
    if (items.size() < 2) return std::string(items.empty() ? "" : items.front());
    return fmt::format("{} and {}", fmt::join(items.begin(), items.end() - 1, ", "), items.back());
}

}  // namespace

MotionSeen motion_seen(std::span<const double> velocity) {
    double fastest = 0.0, count = 0.0;
    for (const double v : velocity) {
        if (!std::isfinite(v)) continue;
        fastest = std::max(fastest, std::abs(v));
        count += 1.0;
    }
    MotionSeen seen;
    const double one = 1.0 / std::max(count, 1.0);
    for (const double v : velocity) {
        if (!std::isfinite(v)) continue;
        if (std::abs(v) <= standstill_share * fastest) {
            seen.rest += one;
            continue;
        }
        (v > 0.0 ? seen.positive : seen.negative) += one;
        if (std::abs(v) <= slow_share * fastest) seen.slowly += one;
    }
    return seen;
}

std::string second_log(const MotionSeen& seen, const MotionAsked& asked,
                       std::span<const std::string_view> rivals) {
    std::vector<std::string_view> clauses, left;
    const auto ask = [&](bool is_missing, std::string_view clause,
                         std::initializer_list<std::string_view> leaves) {
        if (!is_missing) return;
        clauses.push_back(clause);
        for (const std::string_view name : leaves)
            if (std::ranges::find(left, name) == left.end()) left.push_back(name);
    };
    ask(asked.direction && std::min(seen.positive, seen.negative) < least_part, "both directions",
        {"offset", "coulomb-friction"});
    ask(asked.direction && seen.rest < least_part, "rests of 1 s", {"offset", "asymmetric-friction"});
    ask(asked.speed && seen.slowly < least_part, "a fifth of its speed",
        {"coulomb-friction", "viscous-friction", "stribeck-friction"});
    ask(asked.position && !asked.has_position, "a position", {"gravity", "output-ripple"});
    ask(asked.position && asked.has_position && asked.travel_deg < smallest_travel_deg, "a whole turn",
        {"gravity", "output-ripple"});
    ask(asked.load, "another load", {"load-friction"});
    if (clauses.empty()) return {};
    if (!rivals.empty()) left.assign(rivals.begin(), rivals.end());
    std::string more;
    if (left.size() > most_rivals) {
        more = fmt::format(" and {} more", left.size() - most_rivals + 3);
        left.resize(most_rivals - 3);
    }
    return fmt::format("a second log with {} would {} {}", list_of(clauses),
                       left.size() == 1 ? "decide on" : "separate",
                       more.empty() ? list_of(left) : fmt::format("{}{}", fmt::join(left, ", "), more));
}

}  // namespace ripplenotch
