// SPDX-License-Identifier: MIT
#pragma once
// What a name does beside others, and whether it has the form of what is there.

#include "diagnose/beside/weighing/sums.hpp"

namespace ripplenotch {

/// True when `own` is worth its price beside `others` as well.
[[nodiscard]] bool stands_beside(const Sums& sums, const Names& others, std::size_t own, double price);

/// True for a friction of a size below 0. One that is a part of another's curve (quadratic beside viscous
/// friction) may be; what stands for another name by itself may not.
[[nodiscard]] bool drives(const Sums& sums, const Names& names, std::size_t place);

/// rms of its torque along the log about its mean, in Nm.
[[nodiscard]] double swing_nm(const Sums& sums, const Names& names, std::size_t place);

/// How large, beside its own torque, is the largest friction of a size below 0 that is worth its price beside
/// it; 0 without one. What is there then grows with the speed in a way of its own, and the name is only the
/// nearest that the catalogue has. `effects` of the catalogue count for the price.
[[nodiscard]] double mended_part(const Sums& sums, const Names& names, std::size_t place,
                                 std::size_t effects);

}  // namespace ripplenotch
