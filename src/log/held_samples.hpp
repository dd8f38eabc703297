// SPDX-License-Identifier: MIT
#pragma once
// Rows that repeat the row before because nothing new had been measured.

#include <cstddef>

#include "ripplenotch/core/trace.hpp"

namespace ripplenotch {

struct HeldSamples {
    std::size_t count = 0;
    std::size_t longest = 0;  ///< rows in the longest unbroken repetition
};

/// Counts rows whose torque and every other telling channel equal the row before, while the joint moves. A
/// channel tells when it changes in most moving rows: a coarsely quantised torque repeats by itself, and so
/// does the velocity of a perfectly steady motion. Nothing is counted where no channel tells.
[[nodiscard]] HeldSamples count_held(const TraceView& trace);

}  // namespace ripplenotch
