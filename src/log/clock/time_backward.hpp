// SPDX-License-Identifier: MIT
#pragma once
// What is said where the time of a row lies before that of the row before.

#include <cstdint>
#include <string>

namespace ripplenotch {

struct TimeStep {
    double before = 0.0, read = 0.0;  ///< in the unit of the column, less the origin
    std::int64_t origin = 0;
};

/// Both times as the log has them where they are whole numbers, else less the origin. Where the time falls by
/// what a counter of 16 or 32 bits holds, or by a day of seconds, milliseconds, microseconds or nanoseconds,
/// less a step, it began anew there: that is said.
[[nodiscard]] std::string time_backward(const TimeStep& step);

}  // namespace ripplenotch
