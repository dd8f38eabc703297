// SPDX-License-Identifier: MIT
// The unit of a clock that does not say it: from where it counts, or from the rate that it gives.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "log/columns/decide_layout.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/median.hpp"
#include "ripplenotch/core/number.hpp"

namespace ripplenotch::layout_detail {
namespace {

constexpr double lowest_rate_hz = 10.0, highest_rate_hz = 1e5;  // of logs, where a rate decides the unit
constexpr double least_assumed_hz = 1.0;                        // by hand
constexpr double long_ago = 1e9;  // counts from here on are taken relative to the first

struct ClockUnit {
    std::string_view name;
    double seconds;
    double epoch_from, epoch_to;  ///< counts since 1970 (since 1601 for ticks) between 1990 and 2090
    std::string_view since;
};
constexpr std::array clock_units = {
    ClockUnit{"s", 1.0, 6.3e8, 3.8e9, "seconds since 1970"},
    ClockUnit{"ms", 1e-3, 6.3e11, 3.8e12, "milliseconds since 1970"},
    ClockUnit{"us", 1e-6, 6.3e14, 3.8e15, "microseconds since 1970"},
    ClockUnit{"ns", 1e-9, 6.3e17, 3.8e18, "nanoseconds since 1970"},
    ClockUnit{"100ns", 1e-7, 1.22e17, 1.55e17, "ticks of 100 ns since 1601 (FILETIME)"},
};

struct ClockOpening {
    double first = 0.0;
    double step = 0.0;  ///< the median of those that advance; 0 when none does
};

ClockOpening opening_of(const ColumnFacts& facts, std::size_t column) {
    ClockOpening opening;
    if (column >= facts.sample.size()) return opening;
    std::vector<double> steps;
    double before = std::numeric_limits<double>::quiet_NaN();
    for (const double value : facts.sample[column]) {
        if (std::isfinite(value) && !std::isfinite(before)) opening.first = value;
        if (value > before) steps.push_back(value - before);
        if (std::isfinite(value)) before = value;
    }
    if (steps.empty()) return opening;
    opening.step = median_in(steps);
    return opening;
}

double rate_in(const ClockOpening& opening, const ClockUnit& unit) {
    return 1.0 / (opening.step * unit.seconds);
}

// Decimals in a step: the unit is seconds, if that gives a rate at all; so are the least of rates first.
const ClockUnit* unit_of(const ClockOpening& opening, std::string& reason) {
    for (const ClockUnit& unit : clock_units) {
        const bool epoch = opening.first >= unit.epoch_from && opening.first <= unit.epoch_to;
        const double rate = rate_in(opening, unit);
        if (!epoch || rate < least_assumed_hz || rate > 10.0 * highest_rate_hz) continue;
        reason = fmt::format("{:.4g} is a count of {}", opening.first, unit.since);
        return &unit;
    }
    for (const ClockUnit& unit : clock_units) {
        const double rate = rate_in(opening, unit);
        if (rate < lowest_rate_hz * 0.999 || rate > highest_rate_hz * 1.001) continue;
        reason = fmt::format("a step of {:.4g} is then {:.4g} Hz", opening.step, rate);
        return &unit;
    }
    const bool seconds = rate_in(opening, clock_units[0]) >= least_assumed_hz;
    return seconds ? &clock_units[0] : nullptr;
}

void set_origin(const ColumnFacts& facts, const ClockOpening& opening, Layout& layout) {
    if (std::abs(opening.first) < long_ago || std::abs(opening.first) > 9.2e18) return;
    const std::size_t column = *layout.chosen.time;
    const std::int64_t exact = column < facts.first_counts.size() ? facts.first_counts[column] : 0;
    layout.time_origin = exact != 0 ? exact : static_cast<std::int64_t>(opening.first);
}

}  // namespace

void settle_clock(const ColumnFacts& facts, bool unit_is_stated, Layout& layout) {
    if (!layout.chosen.time) return;
    Column& column = layout.columns[*layout.chosen.time];
    const ClockOpening opening = opening_of(facts, *layout.chosen.time);
    layout.time_as_text = !facts.clock_texts.empty() && facts.clock_texts[*layout.chosen.time];
    set_origin(facts, opening, layout);
    const std::string label = column_label(facts.names, *layout.chosen.time);
    if (layout.time_as_text || layout.time_fraction) {
        column.unit = "s";
        column.factor = 1.0;
        column.unit_assumed = false;
        return;
    }
    if (unit_is_stated || opening.step <= 0.0) return;
    std::string reason;
    const ClockUnit* const unit = unit_of(opening, reason);
    if (unit == nullptr) {
        raise<DataError>(
            "{}: {} advances by {} a row and no unit is stated: in seconds that is {:.3g} rows a second, and "
            "no other unit gives {:g} Hz to {:g} kHz; say --unit time=UNIT (s, ms, us, ns), or "
            "--sample-rate",
            layout.source, label, shortest(opening.step), 1.0 / opening.step, lowest_rate_hz,
            1e-3 * highest_rate_hz);
    }
    column.unit = unit->name;
    column.factor = unit->seconds;
    column.unit_assumed = reason.empty();
    if (reason.empty()) reason = "no unit gives a usual rate; seconds are the commonest";
    Assumption read{fmt::format("unit of {}", label),
                    std::string(unit->name),
                    reason,
                    fmt::format("--unit time={}", unit->name),
                    {}};
    (column.unit_assumed ? layout.assumptions : layout.inferences).push_back(std::move(read));
}

}  // namespace ripplenotch::layout_detail
