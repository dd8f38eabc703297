// SPDX-License-Identifier: MIT
// Names of what an identification holds, and what is read off it.
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "ripplenotch/analysis/identification.hpp"

namespace ripplenotch {
namespace {

template <class Value>
using Named = std::pair<Value, std::string_view>;

constexpr std::array findings{Named<RippleFinding>{RippleFinding::ratio, "ratio"},
                              Named<RippleFinding>{RippleFinding::orders, "orders"},
                              Named<RippleFinding>{RippleFinding::one_speed, "one speed"},
                              Named<RippleFinding>{RippleFinding::nothing, "nothing"},
                              Named<RippleFinding>{RippleFinding::too_little, "too little motion"}};
constexpr std::array doubt_reasons{Named<DoubtReason>{DoubtReason::clock, "clock"},
                                   Named<DoubtReason>{DoubtReason::unit, "unit"}};
constexpr std::array abouts{Named<Disagreement::About>{Disagreement::About::ratio, "gear ratio"},
                            Named<Disagreement::About>{Disagreement::About::amplitude, "amplitude"},
                            Named<Disagreement::About>{Disagreement::About::phase, "phase"}};
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

template <class Value, class Table>
std::optional<Value> value_in(const Table& table, std::string_view name) {
    for (const auto& [value, one] : table) {
        if (one == name) return value;
    }
    return std::nullopt;
}

}  // namespace

std::string_view finding_name(RippleFinding finding) { return name_in(findings, finding); }
std::optional<RippleFinding> finding_of(std::string_view name) {
    return value_in<RippleFinding>(findings, name);
}
std::string_view doubt_name(DoubtReason reason) { return name_in(doubt_reasons, reason); }
std::optional<DoubtReason> doubt_of(std::string_view name) {
    return value_in<DoubtReason>(doubt_reasons, name);
}
std::string_view about_name(Disagreement::About about) { return name_in(abouts, about); }
std::optional<Disagreement::About> about_of(std::string_view name) {
    return value_in<Disagreement::About>(abouts, name);
}
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

std::vector<double> undecided_ratios(const GearRatioFit& fit) {
    constexpr double probable = 0.2, beside_it = 0.1;  // by hand: the first of all, the others of the first
    constexpr double same_ratio = 0.5e-4;              // the five digits that are printed
    std::vector<double> ratios;
    if (fit.value || fit.candidates.empty() || fit.candidates.front().score < probable) return ratios;
    for (const RatioCandidate& one : fit.candidates) {
        // Two reasons for one number, such as another unit of the speed, are one ratio.
        const auto is_same = [&](double ratio) {
            return std::abs(ratio - one.value) <= same_ratio * one.value;
        };
        if (one.score > beside_it * fit.candidates.front().score && std::ranges::none_of(ratios, is_same))
            ratios.push_back(one.value);
    }
    return ratios.size() > 1 ? ratios : std::vector<double>{};
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

}  // namespace ripplenotch
