// SPDX-License-Identifier: MIT
#pragma once
// The shape that repeats with every turn of a shaft: time-synchronous averaging over the angle.

#include <cstddef>
#include <span>
#include <vector>

namespace ripplenotch {

/// One turn in equal parts; all vectors have one value a part, nan where no sample fell.
struct TurnAverage {
    std::vector<double> angle_deg;          ///< middle of the part, the first at 0
    std::vector<double> torque_nm;          ///< mean of the samples in it
    std::vector<double> standard_error_nm;  ///< of that mean; nan with fewer than two samples
    std::vector<std::size_t> samples;
    double turns = 0.0;  ///< that the samples went through, back and forth
};

/// Each sample counts to the part that its angle is nearest to; nothing is interpolated. What does not repeat
/// falls with the square root of the number of samples; an order n is passed with the gain
/// sin(pi n / parts) / (pi n / parts) of a part's width when samples fall evenly in it. `turns` and
/// `torque_nm` have one value a sample. Throws UsageError for fewer than 2 parts. O(n).
[[nodiscard]] TurnAverage average_turn(std::span<const double> turns, std::span<const double> torque_nm,
                                       std::size_t parts);

}  // namespace ripplenotch
