// SPDX-License-Identifier: MIT
#include "model/motions.hpp"

namespace ripplenotch {
namespace {

constexpr Key keys[] = {
    {.name = "to-speed",
     .dimension = Dimension::speed,
     .required = true,
     .at_least = -largest_speed_deg_s,
     .at_most = largest_speed_deg_s,
     .help = "speed at its end"},
    {.name = "from-speed",
     .dimension = Dimension::speed,
     .at_least = -largest_speed_deg_s,
     .at_most = largest_speed_deg_s,
     .help = "speed at its beginning; without it, the speed at which the motion before ended, or 0deg/s"},
    duration_key,
    from_key,
};

MotionPiece make(const Settings& settings, const std::optional<MotionState>& before) {
    const double from_deg = start_position_deg("ramp", settings, before);
    const double natural_deg_s = before ? before->velocity_deg_s : 0.0;
    const double from_deg_s = settings.has("from-speed") ? settings.number("from-speed") : natural_deg_s;
    const double to_deg_s = settings.number("to-speed");
    const double duration_s = settings.number("duration");
    const double rate_deg_s2 = (to_deg_s - from_deg_s) / duration_s;
    return {Seconds(duration_s), [=](Seconds elapsed) {
                const double t = elapsed.value();
                // Weighted, so that the end is to-speed to the last bit.
                const double part = t / duration_s;
                return MotionState{from_deg + from_deg_s * t + 0.5 * rate_deg_s2 * t * t,
                                   (1.0 - part) * from_deg_s + part * to_deg_s, rate_deg_s2};
            }};
}

}  // namespace

const MotionKind motions::ramp{
    .name = "ramp",
    .summary = "change the speed evenly",
    .equation = "q(t) = from + from-speed * t + (to-speed - from-speed) * t^2 / (2 * duration)",
    .source = "uniform acceleration (Galilei)",
    .keys = keys,
    .make = make,
};

}  // namespace ripplenotch
