// SPDX-License-Identifier: MIT
#pragma once
// Hypotheses on how an arm and a log of its joints were put together.

#include <vector>

#include "ripplenotch/arm/arm_fit.hpp"
#include "ripplenotch/model/setup_fault.hpp"

namespace ripplenotch {

/// What a fault of an arm has to show.
struct ArmSetupLimits {
    /// Error on fifths left out, geometric mean over the joints, with a hypothesis to that without: half the
    /// squares. Measured on arms of six joints: gravity mended leaves 0.05 of the error, no other direction
    /// or sign of a right one less than 1.
    double most_error = 0.7;
    /// Friction that drives a joint counts where its rms is so much of the fit's error on fifths left out:
    /// below, it is what the fit could not explain.
    double least_friction = 1.0;
};

/// Torques whose sign is reversed or whose unit is mNm: with that corrected the joints, which share the
/// links, fit one arm clearly better on held-out fifths of the log; of all signs and their opposites friction
/// decides. Then, with those torques corrected, whether another direction of gravity along an axis of the
/// base fits clearly better; where all that is right, whether two joints are exchanged. `fit`: of these, as
/// fit_arm made it with these options. Takes as long as a fit of the arm with one window for each joint, five
/// directions and each pair of joints. A factor that all torques share cannot be found: heavier links have
/// it.
[[nodiscard]] std::vector<SetupFault> suspect_arm(const Chain& chain, const ArmLog& log, const ArmFit& fit,
                                                  const ArmFitOptions& options = {},
                                                  const ArmSetupLimits& limits = {});

}  // namespace ripplenotch
