// SPDX-License-Identifier: MIT
#pragma once

#include <complex>

namespace ripplenotch::portable {

/// cos(angle) + i sin(angle), the bits of both, for little more than the price of one.
[[nodiscard]] std::complex<double> phasor(double angle_rad);

}  // namespace ripplenotch::portable
