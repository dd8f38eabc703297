// SPDX-License-Identifier: MIT
#pragma once
// Internal to the log room: what hours, minutes and dates mean on the time axis of one log.

#include <cstdint>
#include <optional>
#include <string_view>

#include "log/clock/stamp.hpp"
#include "ripplenotch/log/time_range.hpp"

namespace ripplenotch {

struct TimeAxis {
    std::optional<ClockTime> first;  ///< of the first row, in logs of dates or times of day
    std::int64_t origin_s = 0;       ///< taken off these
};

/// In seconds on the axis. In logs of times of day or dates, HH:MM and HH:MM:SS are times of the day of the
/// first row, in its zone; elsewhere MM:SS and HH:MM:SS count from the axis' zero. Throws UsageError, which
/// begins with `label` and what was typed, for a date where the log has none, and a time beyond its day.
[[nodiscard]] double on_axis(const TimePoint& point, const TimeAxis& axis, std::string_view label);

}  // namespace ripplenotch
