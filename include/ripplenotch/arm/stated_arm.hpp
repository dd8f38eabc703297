// SPDX-License-Identifier: MIT
#pragma once
// An arm as a part of a model: its chain, and the values of its links once they are known. It predicts the
// torque of one joint along any log of all joints, and needs neither the robot's description nor the log that
// it was fitted to.

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "ripplenotch/arm/arm_fit.hpp"
#include "ripplenotch/arm/arm_term.hpp"
#include "ripplenotch/arm/joint_matching.hpp"

namespace ripplenotch {

struct ArmValues {
    std::vector<double> links;        ///< values_of_a_link each, in the order of arm_columns; not unique
    double rotor_inertia_kgm2 = 0.0;  ///< of the joint's own rotor, as the joint feels it

    bool operator==(const ArmValues&) const = default;
};

/// What is in the torque beside the arm and nobody named: an offset, and friction as BesideArm has it.
struct ArmNuisance {
    double offset_nm = 0.0, coulomb_nm = 0.0, viscous_nm_per_deg_s = 0.0, stribeck_nm = 0.0;

    [[nodiscard]] bool any() const { return *this != ArmNuisance{}; }
    bool operator==(const ArmNuisance&) const = default;
};

struct StatedArm {
    Chain chain;
    std::string joint;                      ///< of the chain: whose torque it is
    std::vector<std::string> log_joints;    ///< names in a log, in the order of the chain
    std::optional<ArmValues> values = {};   ///< left out: fitted
    std::optional<Seconds> smoothing = {};  ///< of the motion that the arm sees; left out: chosen by a fit
    ArmNuisance nuisance = {};

    /// Which joint of the chain is which of a log.
    [[nodiscard]] StatedJoints stated_joints() const;
};

/// The links that values of arm_term's columns mean, `of_term` in their order. Combinations of values that
/// the joint's torque does not tell are those that the fit of all joints gave.
[[nodiscard]] ArmValues arm_values(const Chain& chain, const ArmFit& fit, std::size_t joint,
                                   std::span<const double> of_term,
                                   ArmKnowledge knowledge = ArmKnowledge::other_joints);

/// The torque in newton-metres of one joint along a log: links and rotor, smoothed as arm_term's columns are,
/// so that it is the same torque. Throws what arm_motions throws.
[[nodiscard]] std::vector<double> stated_torque(const Chain& chain, const ArmValues& values,
                                                Seconds smoothing, const ArmLog& log, std::size_t joint);

/// The torque that is beside it, at the speeds of the joint's own log.
[[nodiscard]] std::vector<double> nuisance_torque(const Chain& chain, const ArmNuisance& nuisance,
                                                  const TraceView& log, std::size_t joint);

}  // namespace ripplenotch
