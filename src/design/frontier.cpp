// SPDX-License-Identifier: MIT
#include "ripplenotch/design/guarantee.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "design/band_fit.hpp"
#include "ripplenotch/core/error.hpp"

namespace ripplenotch {
namespace {

constexpr std::array attenuations_db = {6.0, 10.0, 15.0, 20.0, 25.0, 30.0, 35.0, 40.0, 45.0, 50.0, 60.0};
constexpr double step_of_bands = 1.26;  // ten points a decade

TradePoint point_of(const CandidateTable& table) {
    TradePoint point;
    point.bands = table.bands().size();
    point.attenuation_db = table.bands().front().held_attenuation_db;
    point.least_q = point.largest_q = table.bands().front().notches.front().notch.q;
    for (const Band& band : table.bands()) {
        point.attenuation_db = std::min(point.attenuation_db, band.held_attenuation_db);
        point.delay = std::max(point.delay, band.dc_delay);
        point.settle = std::max(point.settle, band.settle);
        point.overshoot_percent = std::max(point.overshoot_percent, band.overshoot_percent);
        for (const CandidateNotch& notch : band.notches) {
            point.least_q = std::min(point.least_q, notch.notch.q);
            point.largest_q = std::max(point.largest_q, notch.notch.q);
        }
    }
    return point;
}

/// A table with so many bands at that delay, as good as it gets; they are known to hold `held_db`, which
/// becomes what they hold.
std::optional<TradePoint> best(const BandSearch& search, std::size_t bands, double delay_s, double& held_db) {
    const QRule rule = search.rule(delay_s);
    const auto held = search.attenuation_db(bands, rule, 0.0, held_db);
    if (!held) return std::nullopt;
    held_db = *held;
    return point_of(search.table(*held, rule));
}

std::vector<std::size_t> counts(std::size_t from, std::size_t to) {
    std::vector<std::size_t> list;
    for (double count = static_cast<double>(from); count <= static_cast<double>(to);
         count = std::max(count + 1.0, std::round(count * step_of_bands))) {
        list.push_back(static_cast<std::size_t>(count));
    }
    return list;
}

// Attenuation against delay with so many bands.
void add_by_attenuation(std::vector<TradePoint>& points, const BandSearch& search, std::size_t bands) {
    BandSearch::KnownDelays known;  // what is too short for one attenuation is so for more
    for (const double db : attenuations_db) {
        double held_db = db + rounding_db;
        const auto delay = search.delay_s(held_db, bands, known);
        if (!delay) return;
        known.short_s = *delay * (1.0 - delay_as_exact);
        const auto point = best(search, bands, *delay, held_db);
        // At the narrowest notches several demands have one answer.
        if (point && (points.empty() || point->attenuation_db > points.back().attenuation_db + 0.05))
            points.push_back(*point);
    }
}

// Bands against delay for one attenuation, the delay within `most_s`.
void add_by_bands(std::vector<TradePoint>& points, const BandSearch& search, double attenuation_db,
                  std::optional<double> most_s, std::optional<std::size_t> most_bands) {
    const double widest_s = most_s ? std::min(*most_s, search.most_delay_s()) : search.most_delay_s();
    const auto fewest = search.bands(attenuation_db + rounding_db, search.rule(widest_s));
    if (!fewest) return;
    const auto at_narrowest = search.bands(attenuation_db + rounding_db, search.rule(search.least_delay_s()));
    const std::size_t last =
        std::min(most_bands.value_or(most_bands_ever), at_narrowest.value_or(most_bands_ever));
    BandSearch::KnownDelays known;  // what is enough for some bands is so for more
    for (const std::size_t count : counts(*fewest, std::min(last, 32 * *fewest))) {
        double held_db = attenuation_db + rounding_db;
        const auto delay = search.delay_s(held_db, count, known);
        if (!delay) continue;
        known.enough_s = *delay;
        if (const auto point = best(search, count, *delay, held_db)) points.push_back(*point);
    }
}

// Bands against attenuation for one delay.
void add_by_delay(std::vector<TradePoint>& points, const BandSearch& search, double delay_s,
                  std::size_t last) {
    double held_db = 0.0;  // what some bands hold, more do
    for (const std::size_t count : counts(1, last))
        if (const auto point = best(search, count, delay_s, held_db)) points.push_back(*point);
}

// The point a design would take, put in its place among the others; one that it beats by nothing gives way.
std::size_t insert(std::vector<TradePoint>& points, const TradePoint& chosen, bool by_attenuation) {
    const auto key = [by_attenuation](const TradePoint& point) {
        return by_attenuation ? point.attenuation_db : static_cast<double>(point.bands);
    };
    const double near = by_attenuation ? 0.05 : 0.5;
    const auto same = [&](const TradePoint& point) { return std::abs(key(point) - key(chosen)) < near; };
    points.erase(std::remove_if(points.begin(), points.end(), same), points.end());
    const auto place = std::find_if(points.begin(), points.end(),
                                    [&](const TradePoint& point) { return key(point) > key(chosen); });
    const auto index = static_cast<std::size_t>(place - points.begin());
    points.insert(place, chosen);
    return index;
}

// Neither limit stated: the delay is that of the notches which settle soonest.
DesignGoal with_delay(const DesignGoal& goal, const BandSearch& search, std::string& reason,
                      const TableSpec& spec) {
    DesignGoal asked = goal;
    if (!asked.most_bands) asked.most_bands = frontier_bands;
    const auto soonest = search.soonest();
    asked.max_delay = Seconds(soonest.delay_s);
    reason = fmt::format(
        "the most attenuation that {} bands hold with notches that settle soonest at {:.4g} deg/s (Q {:.2g}, "
        "{:.0f} ms to {:.4g} %): more attenuation lags and settles longer, less delay rings longer",
        *asked.most_bands, goal.from.value(), soonest.q, 1e3 * soonest.settle_s, spec.settle_band_percent);
    return asked;
}

}  // namespace

Frontier design_frontier(TableSpec spec, DesignGoal goal) {
    if (goal.q) raise<UsageError>("the frontier is found by varying Q; leave --q out");
    if (!spec.bands.empty())
        raise<UsageError>("the frontier is found by varying the bands; give the speeds as FROM:TO");
    const bool by_attenuation = !goal.min_attenuation_db && !goal.max_delay;
    DesignGoal probe = goal;
    if (by_attenuation) probe.max_delay = Seconds(1e9);  // anything, to have the rest of the goal checked
    if (by_attenuation && !probe.most_bands) probe.most_bands = 1;
    DesignChoice choice = design_for(spec, probe);
    const BandSearch search(spec, goal);
    Frontier frontier{spec, goal, {}, 0, choice.reason, std::nullopt};
    if (by_attenuation) choice = design_for(spec, with_delay(goal, search, frontier.reason, spec));
    auto& points = frontier.points;
    const auto most =
        goal.most_bands ? std::optional(static_cast<std::size_t>(*goal.most_bands)) : std::nullopt;
    if (by_attenuation) {
        add_by_attenuation(points, search, most.value_or(frontier_bands));
    } else if (goal.min_attenuation_db) {
        add_by_bands(points, search, *goal.min_attenuation_db,
                     goal.max_delay ? std::optional(goal.max_delay->value()) : std::nullopt, most);
    } else {
        add_by_delay(points, search, goal.max_delay->value(), most.value_or(2 * choice.table.bands().size()));
    }
    const TradePoint chosen = point_of(choice.table);
    frontier.recommended = insert(points, chosen, by_attenuation);
    frontier.slowest = slowest_within(spec, chosen.delay);
    return frontier;
}

}  // namespace ripplenotch
