// SPDX-License-Identifier: MIT
#include "model/motions.hpp"

namespace ripplenotch {
namespace {

constexpr Key keys[] = {
    {.name = "speed",
     .dimension = Dimension::speed,
     .required = true,
     .at_least = -largest_speed_deg_s,
     .at_most = largest_speed_deg_s,
     .help = "speed of the joint; negative turns it the other way"},
    duration_key,
    from_key,
};

MotionPiece make(const Settings& settings, const std::optional<MotionState>& before) {
    const double from_deg = start_position_deg("constant", settings, before);
    const double speed_deg_s = settings.number("speed");
    return {Seconds(settings.number("duration")), [=](Seconds elapsed) {
                return MotionState{from_deg + speed_deg_s * elapsed.value(), speed_deg_s, 0.0};
            }};
}

}  // namespace

const MotionKind motions::constant{
    .name = "constant",
    .summary = "turn at one speed, at that speed from the first sample",
    .equation = "q(t) = from + speed * t",
    .source = "the paper's runs at 60, 120 and 180 deg/s (Kim, Kim, Song, Trans. KSME A, 2011, fig. 1)",
    .keys = keys,
    .make = make,
};

}  // namespace ripplenotch
