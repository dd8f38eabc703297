// SPDX-License-Identifier: MIT
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "ripplenotch/diagnose/diagnosis.hpp"
#include "ripplenotch/diagnose/plan.hpp"
#include "ripplenotch/model/model.hpp"
#include "ripplenotch/model/noise.hpp"

namespace ripplenotch {

// Motions of the Fourier family within limits, by numbers that are drawn.

struct FourierMotion {
    std::vector<double> speeds_deg_s;
    double place = 0.5;  ///< position of the span within the range that remains, 0 to 1
};

[[nodiscard]] FourierMotion drawn(Noise& noise);

/// Moved a little: by `step` of its own size.
[[nodiscard]] FourierMotion moved(const FourierMotion& motion, double step, Noise& noise);

/// Standstill, the motion with its acceleration 0 at both ends and as large as the limits permit, standstill;
/// together `duration`. Arguments for make_motion.
[[nodiscard]] std::vector<std::string> within(const FourierMotion& motion, const MotionLimits& limits,
                                              Seconds duration);

}  // namespace ripplenotch
