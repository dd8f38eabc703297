// SPDX-License-Identifier: MIT
#include "model/effects.hpp"

namespace ripplenotch {
namespace {

// Places at which a screening of a log begins.
constexpr double tried_errors[] = {-1.0, -0.5, -0.25, -0.12, -0.06, -0.03, 0.03, 0.06, 0.12, 0.25, 0.5, 1.0};

constexpr Parameter parameters[] = {
    {.name = "error_percent",
     .unit = "%",
     .help = "by which the gear ratio is larger than in the model",
     .start = 0.1,
     .lower = -99.0,
     .upper = 900.0,
     .tried = tried_errors,
     .hint = Hint::gear_ratios},
};

constexpr LookAlike look_alikes[] = {
    {"velocity-bias", "the log is one stroke",
     "strokes both ways: the phase error of a ratio returns, that of a bias grows on"},
    {"ripple-modulation", "the joint turns less than a revolution", "a travel of a whole output revolution"},
    {"a wrong scale of the position or velocity", "always, unless the travel is known",
     "the travel of a known move"},
};

void change_motion(std::span<const double> values, Motion&, GearRatio& ratio) {
    ratio = GearRatio(ratio.value() * (1.0 + 0.01 * values[0]));
}

}  // namespace

const Effect effects::gear_ratio{
    .name = "gear-ratio",
    .summary = "the gear ratio differs from that of the model",
    .equation = "gear_ratio * (1 + error_percent / 100) replaces gear_ratio",
    .symptom =
        "lines of the ripple in the residual whose phase error grows with the angle gone; with quite another "
        "ratio, lines at orders that the model does not have",
    .look_alikes = look_alikes,
    .source = "the definition of the ratio",
    .side = Side::motion,
    .domain = Domain::order,
    .parameters = parameters,
    .change_motion = change_motion,
};

}  // namespace ripplenotch
