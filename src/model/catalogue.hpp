// SPDX-License-Identifier: MIT
#pragma once
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "model/evaluate.hpp"
#include "ripplenotch/model/model.hpp"

namespace ripplenotch {

// Torques of polar terms (ripple, tones, gravity) of size 1 along one motion, at phases of 0 and 90 degrees.
// Any size, phase and ripple gain is a sum of the two; finding them takes a cosine and a sine a sample, which
// trials of the same terms need not do again and again.

class Carriers {
  public:
    /// Adds the torque of a joint term, multiplied by the ripple gain; false, and nothing is added, where the
    /// effect has no such parts. The situation has the motion of every other call.
    [[nodiscard]] bool add_torque(const Term& term, const Situation& situation, const Gain& gain,
                                  std::span<double> torque_nm);

  private:
    struct Carrier {
        Term term;  ///< with a size of 1 and a phase of 0
        GearRatio ratio;
        std::vector<double> along_nm, across_nm;
    };

    const Carrier& carrier(const Term& term, const Situation& situation);

    std::vector<Carrier> kept_;  ///< the latest, in turns
    std::size_t next_ = 0;
};

// Detectors of the direction of motion, its starts and its stops from a noisy speed, sample by sample. Two
// thresholds each, so that noise about one of them does not count as motion.

/// The direction in which the joint last clearly moved: -1, 1, or 0 before it first did.
class HeldDirection {
  public:
    static constexpr double clear_deg_s = 0.5;  // chosen, not derived
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
    // Chosen, not derived: apart, so that noise does not start it again.
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
