// SPDX-License-Identifier: MIT
#pragma once
// Internal: in which rows of a log the joint's motion is known, and what it lets be determined of the joint.
// Where the speed jumps, the acceleration is unknown, and a speed smoothed over the jump is none that the
// joint had.

#include <span>
#include <vector>

#include "ripplenotch/core/trace.hpp"
#include "ripplenotch/fleet/features.hpp"
#include "ripplenotch/model/effect.hpp"

namespace ripplenotch {

/// A 1 for each row within whose smoothing window the logged speed is that of `motion`, to 8 deviations of
/// its noise or a fiftieth of the usual speed; else 0. `motion` is motion_along(log).
[[nodiscard]] std::vector<unsigned char> rows_of_known_motion(const TraceView& log, const Motion& motion);

/// The identifiability of inertia from the acceleration in the rows of known motion.
struct Accelerations {
    bool known = false;          ///< separable from direction and speed, and above the noise
    bool like_friction = false;  ///< known only along with direction and speed: inertia and friction alike
};
[[nodiscard]] Accelerations accelerations_of(const TraceView& log, const Motion& motion,
                                             const std::vector<unsigned char>& rows);

struct MotionFacts {
    MotionMix mix;
    double moving_deg_s = 0.0;     ///< slower samples count as resting
    double speed_rms_deg_s = 0.0;  ///< rms speed of all samples
    double acceleration_rms_rad_s2 = 0.0;
    bool has_position = false;
    Accelerations accelerations;

    [[nodiscard]] bool both_directions() const;
    [[nodiscard]] bool several_speeds() const;
};

/// The input of a fit: a motion, its torque, and a 1 for each sample that counts.
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

/// At standstill, presliding friction without a fitted angle may have any value: only samples that move
/// count. All samples count where too few move for a fit.
[[nodiscard]] std::vector<unsigned char> moving_samples(const Motion& motion, std::vector<unsigned char> use,
                                                        double moving_deg_s);

/// Before the joint has moved, its friction may stand anywhere: the samples of its first way do not count.
void leave_out_start(const Motion& motion, double way_deg, std::vector<unsigned char>& use);

}  // namespace ripplenotch
