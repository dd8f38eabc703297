// SPDX-License-Identifier: MIT
#pragma once
// Sections in direct form I, whose memory is past inputs and outputs.

#include <span>

#include "ripplenotch/core/biquad.hpp"

namespace ripplenotch {

/// Inputs and outputs of a section one and two samples ago.
struct Past {
    double x1 = 0.0, x2 = 0.0, y1 = 0.0, y2 = 0.0;
};

/// The latest output comes last in the sum: the next sample waits for it through two operations.
inline double advance(const Biquad& f, Past& past, double x) noexcept {
    const double y = f.b0 * x + f.b1 * past.x1 + f.b2 * past.x2 - f.a2 * past.y2 - f.a1 * past.y1;
    past = {x, past.x1, y, past.y1};
    return y;
}

/// out = origin + F(in - origin), the bits of advance(), section after section. `past` has one entry a
/// section; `in` may be `out`.
void run_direct_form(std::span<const Biquad> sections, std::span<Past> past, std::span<const double> in,
                     double origin, std::span<double> out);

}  // namespace ripplenotch
