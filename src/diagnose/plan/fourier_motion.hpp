// SPDX-License-Identifier: MIT
#pragma once
// Motions of the Fourier family within limits, by numbers that are drawn.

#include <string>
#include <vector>

#include "ripplenotch/diagnose/plan.hpp"
#include "ripplenotch/model/fit.hpp"

namespace ripplenotch {

/// Half-waves of a planned motion.
inline constexpr std::size_t planned_waves = 10;
inline constexpr double planned_rest_s = 0.5;  ///< before and after

struct FourierMotion {
    std::vector<double> speeds_deg_s;
    double place = 0.5;  ///< of the span within what the range leaves free, 0 to 1
};

[[nodiscard]] FourierMotion drawn(Noise& noise);
/// Moved a little: by `step` of its own size.
[[nodiscard]] FourierMotion moved(const FourierMotion& motion, double step, Noise& noise);

/// Rest, the motion with its acceleration 0 at both ends and as large as the limits let it be, rest; together
/// `duration`. Words for make_motion.
[[nodiscard]] std::vector<std::string> within(const FourierMotion& motion, const MotionLimits& limits,
                                              Seconds duration);

}  // namespace ripplenotch
