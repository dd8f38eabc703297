// SPDX-License-Identifier: MIT
#pragma once
// A fitted arm as part of a model: columns that a search leaves alone and fits with everything it tries.

#include <optional>
#include <span>

#include "ripplenotch/arm/arm_fit.hpp"
#include "ripplenotch/model/given_term.hpp"

namespace ripplenotch {

/// What is known of the arm before the torque of the joint in hand is looked at.
enum class ArmKnowledge {
    /// Nothing but the pull: a value a column, its mean 0, its deviation ArmFit::deviation.
    pull,
    /// What the other joints' torques say, too. Values that they tell together are no longer values of one
    /// link: a column a combination, with a mean and a deviation of 1 in it.
    other_joints,
};

/// Columns for the rows of `log`, those of links before the joint left out, and the rotor's last where it can
/// be told from them; all smoothed over ArmFit::smoothing. Deviations are for a fit in which each row of the
/// log is a measurement with deviation `row_noise_nm`: the knowledge weighs there what it weighs in the fit
/// of the arm. Left out: what the arm left of this joint's torque, spread over the rows that the fit took for
/// one. `motions`: arm_motions of the log over ArmFit::smoothing, where they are known already.
[[nodiscard]] GivenTerm arm_term(const Chain& chain, const ArmFit& fit, const ArmLog& log, std::size_t joint,
                                 ArmKnowledge knowledge = ArmKnowledge::other_joints,
                                 std::optional<double> row_noise_nm = {},
                                 std::span<const Motion> motions = {});

}  // namespace ripplenotch
