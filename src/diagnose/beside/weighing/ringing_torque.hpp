// SPDX-License-Identifier: MIT
#pragma once
// What passes the elastic joint makes of a ripple.

#include <complex>
#include <vector>

#include "diagnose/beside/weighing/shapes.hpp"

namespace ripplenotch {

/// Of the part that rings, a value per sample of the motion; the shape has one.
[[nodiscard]] std::vector<std::complex<double>> ringing_gain(const Shape& shape, const Motion& motion,
                                                             GearRatio ratio);
/// Where the ripple that does not pass the elastic joint is told, and its phase.
[[nodiscard]] Polar direct_of(const Effect& effect);
/// The term with this part, complex, of what rings.
[[nodiscard]] Term ringing_term(const Shape& shape, std::complex<double> direct);

}  // namespace ripplenotch
