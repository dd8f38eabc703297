// SPDX-License-Identifier: MIT
#pragma once
// A trade-off curve as people read it.

#include <string>
#include <string_view>

#include "ripplenotch/design/frontier.hpp"

namespace ripplenotch {

/// The curve, one row a point with the recommended one marked, and one line that says why it.
[[nodiscard]] std::string frontier_to_text(const Frontier& frontier);

/// "No notch of Q 5 or less is within 20 ms below 4.3 deg/s."
[[nodiscard]] std::string slowest_sentence(Seconds delay, DegPerSec slowest);

/// "Recommended: 40.4 dB with 82.6 ms in 32 bands: ...", with the reason.
[[nodiscard]] std::string recommended_sentence(const Frontier& frontier);

/// What a delay asks of the control loop: "At a crossover of 1 Hz this delay costs a loop 30 deg of phase;
/// ..."
[[nodiscard]] std::string crossover_sentence(Seconds delay, std::string_view aside = "");

}  // namespace ripplenotch
