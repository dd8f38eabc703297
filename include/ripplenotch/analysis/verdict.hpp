// SPDX-License-Identifier: MIT
#pragma once
// What an identification comes to, as values; the words are made of them in one place, verdict_sentence.
//
// Another reason for doubt is a name in DoubtReason and a Doubt from whoever knows of it: in
// IdentifyOptions::doubts when it is known before the lines are looked for, with cast_doubt() when it follows
// from what was found. A finding under a doubt is no verdict: the sentence begins with "Cannot tell:" and the
// doubts, in the order in which they came, and the identification is not conclusive.

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "ripplenotch/core/units.hpp"

namespace ripplenotch {

/// What the lines come to.
enum class RippleFinding {
    ratio,       ///< ripple that turns with the joint, and the gear ratio
    orders,      ///< ripple that turns with the joint; its gear ratio stays open
    one_speed,   ///< lines, all at one speed, where an order and a fixed tone look alike
    nothing,     ///< surely no ripple above SearchedOrders::detectable_nm in that range
    too_little,  ///< the joint is at rest, or moves too little to say anything
};
[[nodiscard]] std::string_view finding_name(RippleFinding finding);
/// Empty where nothing has this name.
[[nodiscard]] std::optional<RippleFinding> finding_of(std::string_view name);

/// Why the lines are not believed whatever they show.
enum class DoubtReason {
    clock,  ///< position, velocity and time contradict each other
    unit,   ///< the unit of the motion is not stated, and another suits the lines as well
};
[[nodiscard]] std::string_view doubt_name(DoubtReason reason);
/// Empty where nothing has this name.
[[nodiscard]] std::optional<DoubtReason> doubt_of(std::string_view name);

struct Doubt {
    DoubtReason reason = DoubtReason::clock;
    std::string because;  ///< half a sentence, with what would settle it; no capital, no full stop
    bool operator==(const Doubt&) const = default;
};

/// What a verdict rests on.
struct Grounds {
    std::size_t sweeps = 0, rests = 0;  ///< pieces of motion in one direction, and of standstill
    double sweep_turns = 0.0;           ///< output turns that the sweeps cover
    double slowest_deg_s = 0.0, fastest_deg_s = 0.0;
    double false_alarm = 0.0;
};

}  // namespace ripplenotch
