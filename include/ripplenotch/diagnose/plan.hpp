// SPDX-License-Identifier: MIT
#pragma once
// The motion after which a log would decide what this one left open.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "ripplenotch/diagnose/diagnosis.hpp"

namespace ripplenotch {

/// The limits of the joint.
struct MotionLimits {
    double speed_deg_s = 0.0, acceleration_deg_s2 = 0.0;
    double lowest_deg = 0.0, highest_deg = 0.0;  ///< positions
};
/// Throws UsageError: a limit that is not above 0, a range without width.
void check(const MotionLimits& limits);

struct PlanOptions {
    Seconds longest{30.0};  ///< chosen, not derived
    std::uint64_t seed = 1;
    Hertz sample_rate{1000.0};  ///< chosen, not derived
    Seconds smoothing = default_smoothing;
    DiagnosisRules rules = {};
};

/// Two effects that a planned motion is to distinguish.
struct PlanQuestion {
    std::string effect;  ///< a side of a tie, an uncertain finding, or one that has to be found again
    /// The effect that imitates it best along the planned motion; empty: all else together.
    std::string rival;
    bool open = true;          ///< whether the log left it open
    double gain_before = 0.0;  ///< along the log's own motion; 0 below 1
    double gain = 0.0;         ///< along the planned one: fall of the squares that only the effect brings, in
                               ///< units of the noise's variance
};

struct MotionPlan {
    std::vector<std::string> motions;  ///< for make_motion and `simulate --motion`
    Motion motion;                     ///< the same, sampled
    std::vector<PlanQuestion> questions;
    /// Each gain is rules.advice.plan_gain or more, or half of its previous value where the log determined
    /// it.
    bool decides = false;
    [[nodiscard]] Seconds duration() const;
};

/// The shortest motion of some durations up to the longest along which the least gain of all questions is
/// enough, or else the longest of most. A gain is that of T-optimal design (Atkinson and Fedorov, Biometrika
/// 62, 1975): the residual of an effect's torque after a fit of all else in the model, an offset and the
/// rival's best form, squared, over the noise's variance. Motions are Fourier sums (Swevers et al., 1997),
/// drawn and improved by the seed: the same on every machine. Empty where the log left nothing open that a
/// motion of the joint could decide. Throws UsageError of check().
[[nodiscard]] std::optional<MotionPlan> plan_motion(const Diagnosis& diagnosis, const TraceView& log,
                                                    const MotionLimits& limits,
                                                    const PlanOptions& options = {});

}  // namespace ripplenotch
