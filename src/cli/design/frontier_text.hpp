// SPDX-License-Identifier: MIT
#pragma once
// A trade-off curve as people read it.

#include <string>

#include "ripplenotch/design/frontier.hpp"

namespace ripplenotch {

/// The curve, one row a point with the recommended one marked, and one line that says why it.
[[nodiscard]] std::string frontier_to_text(const Frontier& frontier);

/// "No notch of Q 5 or less is within 20 ms below 4.3 deg/s."
[[nodiscard]] std::string slowest_sentence(Seconds delay, DegPerSec slowest);

}  // namespace ripplenotch
