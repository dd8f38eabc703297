// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "log/clock/stamp.hpp"
#include "ripplenotch/log/layout.hpp"

namespace ripplenotch {

// Internal to the log room: what hours, minutes and dates mean on the time axis of one log.

struct TimeAxis {
    std::optional<ClockTime> first;  ///< of the first row, in logs of dates or times of day
    std::int64_t origin_s = 0;       ///< taken off these
};

/// In seconds on the axis. In logs of times of day or dates, HH:MM and HH:MM:SS are times of the day of the
/// first row, in its zone; elsewhere MM:SS and HH:MM:SS count from the axis' zero. Throws UsageError, which
/// begins with `label` and what was typed, for a date where the log has none, and a time beyond its day.
[[nodiscard]] double on_axis(const TimePoint& point, const TimeAxis& axis, std::string_view label);

// What is said where the time of a row lies before that of the row before.

struct TimeStep {
    double before = 0.0, read = 0.0;  ///< in the unit of the column, less the origin
    std::int64_t origin = 0;
};

/// Both times as the log has them where they are whole numbers, else less the origin. Where the time falls by
/// what a counter of 16 or 32 bits holds, or by a day of seconds, milliseconds, microseconds or nanoseconds,
/// less a step, it began anew there: that is said.
[[nodiscard]] std::string time_backward(const TimeStep& step);

}  // namespace ripplenotch
