// SPDX-License-Identifier: MIT
#pragma once
// What people are told about a clock, whether the log was in memory or went by.

#include <string>
#include <vector>

#include "log/held_samples.hpp"
#include "ripplenotch/log/timebase.hpp"

namespace ripplenotch {

struct ClockTroubles {
    std::size_t rows = 0, gaps = 0, repeated_times = 0;
    Gap longest_gap;
    HeldSamples held;

    /// Counts it.
    void add_gap(const Gap& gap);
};

/// Whether so many rows among them are told of when they hold the sample before.
[[nodiscard]] bool worth_telling(const ClockTroubles& troubles, std::size_t held);

[[nodiscard]] std::vector<std::string> timebase_warnings(const ClockTroubles& troubles);

}  // namespace ripplenotch
