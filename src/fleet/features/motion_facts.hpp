// SPDX-License-Identifier: MIT
#pragma once
// Internal: what the motion of a log lets be told of the joint.

#include <span>
#include <vector>

#include "fleet/features/known_motion.hpp"
#include "ripplenotch/fleet/feature_line.hpp"
#include "ripplenotch/model/effect.hpp"

namespace ripplenotch {

struct MotionFacts {
    MotionMix mix;
    double moving_deg_s = 0.0;     ///< slower samples count as resting
    double speed_rms_deg_s = 0.0;  ///< of all samples
    double acceleration_rms_rad_s2 = 0.0;
    bool has_position = false;
    Accelerations accelerations;

    [[nodiscard]] bool both_directions() const;
    [[nodiscard]] bool several_speeds() const;
};

/// What is fitted: a motion, its torque, and a 1 for each sample that counts.
struct FittedSamples {
    Motion motion;
    std::vector<double> torque_nm;
    std::vector<unsigned char> use;
};

/// At most so many samples, evenly spread.
[[nodiscard]] FittedSamples thinned(const Motion& motion, std::span<const double> torque_nm,
                                    std::span<const unsigned char> use, std::size_t most);

[[nodiscard]] MotionFacts motion_facts(const Motion& motion, std::span<const double> torque_nm,
                                       bool has_position);

/// Samples that count, of less way than that since the joint last reversed.
[[nodiscard]] std::size_t samples_after_reversals(const Motion& motion, std::span<const unsigned char> use,
                                                  double most_deg);

/// At rest, friction that has no angle to turn over in may stand anywhere: only samples that move count. All
/// of them again where the rest is too little to fit.
[[nodiscard]] std::vector<unsigned char> moving_samples(const Motion& motion, std::vector<unsigned char> use,
                                                        double moving_deg_s);

/// Before the joint has moved, its friction may stand anywhere: the samples of its first way do not count.
void leave_out_start(const Motion& motion, double way_deg, std::vector<unsigned char>& use);

}  // namespace ripplenotch
