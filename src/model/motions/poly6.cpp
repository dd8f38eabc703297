// SPDX-License-Identifier: MIT
// A polynomial with position, speed and acceleration given at both ends (here: standstill) has six
// coefficients and degree five. A seventh coefficient adds a multiple of u^3 (1 - u)^3, the one polynomial of
// degree six that changes none of the six end values; it moves the moment of greatest speed off the middle.
// docs/motions/poly6.md has the figures.
#include <cmath>

#include "model/motions.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"

namespace ripplenotch {
namespace {

constexpr Key keys[] = {
    {.name = "to",
     .dimension = Dimension::angle,
     .required = true,
     .at_least = -largest_angle_deg,
     .at_most = largest_angle_deg,
     .help = "position at its end"},
    duration_key,
    from_key,
    {.name = "asymmetry",
     .default_text = "0",
     .at_least = -1.0,  // beyond, the joint would turn back on its way
     .at_most = 1.0,
     .help =
         "-1 to 1: above 0 the greatest speed comes early, below 0 late; 0 is the polynomial of degree five"},
};

struct Shape {
    double position, velocity, acceleration;  ///< a move from 0 to 1 in unit time
};

Shape shape(double u, double asymmetry) {
    const double w = 1.0 - u;
    const double bump = u * w;
    const double lean = 1.0 - 2.0 * u;
    return {
        u * u * u * (10.0 - 15.0 * u + 6.0 * u * u) + 10.0 * asymmetry * bump * bump * bump,
        30.0 * bump * bump * (1.0 + asymmetry * lean),
        60.0 * bump * (lean * (1.0 + asymmetry * lean) - asymmetry * bump),
    };
}

MotionPiece make(const Settings& settings, const std::optional<MotionState>& before) {
    const double from_deg = start_position_deg("poly6", settings, before);
    const double travel_deg = settings.number("to") - from_deg;
    const double duration_s = settings.number("duration");
    const double asymmetry = settings.number("asymmetry");
    return {Seconds(duration_s), [=](Seconds elapsed) {
                const Shape s = shape(elapsed.value() / duration_s, asymmetry);
                return MotionState{from_deg + travel_deg * s.position, travel_deg * s.velocity / duration_s,
                                   travel_deg * s.acceleration / (duration_s * duration_s)};
            }};
}

}  // namespace

const MotionKind motions::poly6{
    .name = "poly6",
    .summary = "move from rest to rest on a smooth polynomial",
    .equation =
        "q(t) = from + (to - from) * (10 u^3 - 15 u^4 + 6 u^5 + 10 asymmetry u^3 (1 - u)^3), u = t / "
        "duration",
    .source =
        "the paper's move (Kim, Kim, Song, Trans. KSME A, 2011, fig. 11); degree five: Flash and Hogan, "
        "1985",
    .keys = keys,
    .make = make,
};

}  // namespace ripplenotch
