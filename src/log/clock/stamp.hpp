// SPDX-License-Identifier: MIT
#pragma once
// Stamps of a log: counts from long ago with more digits than a double holds, seconds and nanoseconds in two
// columns, times of day and dates.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "ripplenotch/log/layout.hpp"

namespace ripplenotch {

/// How the time cells of a log are turned into numbers.
struct StampRule {
    bool careful = false;     ///< false: a time is a number like others
    bool text = false;        ///< cells as in clock_text()
    std::int64_t origin = 0;  ///< in the unit of the column; taken off before anything is rounded
    char decimal_mark = '.';
    StampForm form = {};
};

/// What clock_text() reads, for messages.
inline constexpr std::string_view stamp_forms =
    "12:30:01.5, 2024-05-01T12:30:01.5Z, 2024-05-01 12:30:01,500, 1.5.2024 12:30:01,5 or 5/1/2024 12:30:01 "
    "PM";

/// Seconds of "0.002 sec"; since midnight of "12:30:01.5", since 1970 of a date and time: ISO 8601 in full, a
/// zone offset at its end is taken into account; with slashes; "1.5.2024 12:30:01", the day first; "5/1/2024
/// 12:30:01 PM", in the order that the form says unless a field above 12 does. Empty for other texts.
struct ClockTime {
    std::int64_t whole_s = 0;
    double fraction_s = 0.0;  ///< 0 to 1
    bool dated = false;
    std::optional<std::int64_t> zone_s;  ///< east of Greenwich, where the text says it; taken off already
};
[[nodiscard]] std::optional<ClockTime> clock_text(std::string_view text, StampForm form = {});

/// What a time cell says, less the origin, exact to a double's last digit of the difference.
[[nodiscard]] std::optional<double> read_stamp(std::string_view text, const StampRule& rule);

/// `count - origin` as a double: of whole numbers, with no rounding before the difference where that is one
/// too.
[[nodiscard]] inline double since(std::int64_t count, std::int64_t origin) {
    std::int64_t difference = 0;
    return __builtin_sub_overflow(count, origin, &difference)
               ? static_cast<double>(count) - static_cast<double>(origin)
               : static_cast<double>(difference);
}

// What hours, minutes and dates mean on the time axis of one log.

struct TimeAxis {
    std::optional<ClockTime> first;  ///< of the first row, in logs of dates or times of day
    std::int64_t origin_s = 0;       ///< taken off these
};

/// In seconds on the axis. In logs of times of day or dates, HH:MM and HH:MM:SS are times of the day of the
/// first row, in its zone; elsewhere MM:SS and HH:MM:SS count from the axis' zero. Throws UsageError, which
/// begins with `label` and what was typed, for a date where the log has none, and a time beyond its day.
[[nodiscard]] double on_axis(const TimePoint& point, const TimeAxis& axis, std::string_view label);

/// What is said where the time `read` in a row lies `before` that of the row before, both in the unit of the
/// column, less the origin: as the log has them where they are whole numbers. Where the time falls by what a
/// counter of 16 or 32 bits holds, or by a day of seconds, milliseconds, microseconds or nanoseconds,
/// less a step, it began anew there: that is said.
[[nodiscard]] std::string time_backward(double before, double read, std::int64_t origin);

}  // namespace ripplenotch
