// SPDX-License-Identifier: MIT
#include "ripplenotch/arm/stated_arm.hpp"

#include <numbers>

#include "arm/fit/arm_rows.hpp"
#include "arm/fit/parting.hpp"
#include "arm/fit/smooth_along.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/model/measured_motion.hpp"

namespace ripplenotch {

StatedJoints StatedArm::stated_joints() const {
    StatedJoints pairs;
    for (std::size_t j = 0; j < log_joints.size(); ++j)
        pairs.emplace_back(chain.joints[j].name, log_joints[j]);
    return pairs;
}

ArmValues arm_values(const Chain& chain, const ArmFit& fit, std::size_t joint,
                     std::span<const double> of_term, ArmKnowledge knowledge) {
    const ArmJointFit* const own = fit.find(joint);
    const bool rotor = rotor_is_identifiable(chain, joint);
    const std::size_t links = values_of_a_link * chain.size(), before = values_of_a_link * joint;
    if (own == nullptr || of_term.size() != links - before + (rotor ? 1 : 0))
        raise<UsageError>("arm: {} values for joint {} of {}", of_term.size(), joint + 1, chain.source);
    ArmValues values;
    if (rotor) values.rotor_inertia_kgm2 = of_term.back();
    if (knowledge == ArmKnowledge::other_joints && fit.joints.size() > 1) {
        const Parting parting(*own);
        Eigen::VectorXd parted = parting.of_values();
        for (std::size_t v = before; v < links; ++v)
            parted[static_cast<Eigen::Index>(v)] = of_term[v - before];
        const Eigen::VectorXd found = parting.values_of(parted);
        values.links.assign(found.begin(), found.end());
        return values;
    }
    values.links.assign(before, 0.0);
    values.links.insert(values.links.end(), of_term.begin(),
                        of_term.begin() + static_cast<std::ptrdiff_t>(links - before));
    return values;
}

std::vector<double> stated_torque(const Chain& chain, const ArmValues& values, Seconds smoothing,
                                  const ArmLog& log, std::size_t joint) {
    const auto motions = arm_motions(log, smoothing);
    std::vector<double> torque_nm = arm_torque(chain, values.links, motions, joint);
    const double unit = chain.joints[joint].kind == JointKind::revolute ? std::numbers::pi / 180.0 : 1.0;
    for (std::size_t k = 0; k < torque_nm.size(); ++k)
        torque_nm[k] += values.rotor_inertia_kgm2 * unit * motions[joint].acceleration_deg_s2[k];
    return smooth_along(log.joints[joint].time_s, torque_nm, smoothing);
}

std::vector<double> nuisance_torque(const Chain& chain, const ArmNuisance& nuisance, const TraceView& log,
                                    std::size_t joint) {
    std::vector<double> torque_nm(log.size(), nuisance.offset_nm);
    if (ArmNuisance{.offset_nm = nuisance.offset_nm} == nuisance) return torque_nm;
    const Motion motion = motion_along(log, default_smoothing);
    const double unit = deg_s_of(chain.joints[joint].kind);
    for (std::size_t k = 0; k < torque_nm.size(); ++k) {
        const FrictionBeside friction = friction_beside(unit * motion.velocity_deg_s[k]);
        torque_nm[k] += nuisance.coulomb_nm * friction.side + nuisance.stribeck_nm * friction.stribeck +
                        nuisance.viscous_nm_per_deg_s * unit * motion.velocity_deg_s[k];
    }
    return torque_nm;
}

}  // namespace ripplenotch
