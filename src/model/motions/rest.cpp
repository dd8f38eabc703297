// SPDX-License-Identifier: MIT
#include "model/motions.hpp"

namespace ripplenotch {
namespace {

constexpr Key keys[] = {duration_key, from_key};

MotionPiece make(const Settings& settings, const std::optional<MotionState>& before) {
    const MotionState state{.position_deg = start_position_deg("rest", settings, before)};
    return {Seconds(settings.number("duration")), [state](Seconds) { return state; }};
}

}  // namespace

const MotionKind motions::rest{
    .name = "rest",
    .summary = "stand still",
    .equation = "q(t) = from",
    .source = "the paper's run at 0 deg/s, which shows the sensor's noise alone",
    .keys = keys,
    .make = make,
};

}  // namespace ripplenotch
