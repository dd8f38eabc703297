// SPDX-License-Identifier: MIT
#pragma once
// What a speed with noise says about the direction of motion, its starts and its stops, sample by sample. Two
// thresholds each, so that noise about one of them does not count as motion.

#include <cmath>

namespace ripplenotch {

/// The direction in which the joint last clearly moved: -1, 1, or 0 before it first did.
class HeldDirection {
  public:
    static constexpr double clear_deg_s = 0.5;  // by hand
    int update(double velocity_deg_s) {
        if (std::abs(velocity_deg_s) > clear_deg_s) held_ = velocity_deg_s > 0.0 ? 1 : -1;
        return held_;
    }

  private:
    int held_ = 0;
};

/// Starts and stops. A log may begin in motion; that is no start.
class Movement {
  public:
    // By hand: apart, so that noise does not start it again.
    static constexpr double start_deg_s = 1.0, stop_deg_s = 0.5;
    /// At a start the direction, 1 or -1; at a stop the direction before it, negated; else 0.
    double kick(double velocity_deg_s) {
        const double speed = std::abs(velocity_deg_s);
        const bool first = !begun_;
        begun_ = true;
        if (direction_ == 0.0 && speed > start_deg_s) {
            direction_ = velocity_deg_s > 0.0 ? 1.0 : -1.0;
            return first ? 0.0 : direction_;
        }
        if (direction_ != 0.0 && speed < stop_deg_s) {
            const double before = direction_;
            direction_ = 0.0;
            return -before;
        }
        if (speed > start_deg_s) direction_ = velocity_deg_s > 0.0 ? 1.0 : -1.0;
        return 0.0;
    }

  private:
    bool begun_ = false;
    double direction_ = 0.0;
};

}  // namespace ripplenotch
