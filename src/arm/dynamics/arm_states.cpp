// SPDX-License-Identifier: MIT
#include "arm/dynamics/arm_states.hpp"

#include <numbers>

#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {

ArmStates::ArmStates(const Chain& chain, std::span<const Motion> motions) : states_(chain.size()) {
    if (motions.size() != chain.size())
        raise<UsageError>("arm: {} motions for {} joints", motions.size(), chain.size());
    samples_ = motions.front().size();
    for (std::size_t j = 0; j < chain.size(); ++j) {
        const Motion& motion = motions[j];
        if (motion.size() != samples_ || motion.position_deg.size() != samples_)
            raise<UsageError>("arm: motions of {} and {} samples", samples_, motion.size());
        Joint joint{&motion, chain.joints[j].kind == JointKind::revolute, {}, {}};
        if (joint.turns) {
            joint.cosine.resize(samples_);
            joint.sine.resize(samples_);
            portable::cos_degrees(motion.position_deg, joint.cosine);
            portable::sin_degrees(motion.position_deg, joint.sine);
        }
        joints_.push_back(std::move(joint));
    }
}

std::span<const JointState> ArmStates::at(std::size_t k) {
    constexpr double radians = std::numbers::pi / 180.0;
    for (std::size_t j = 0; j < joints_.size(); ++j) {
        const Joint& joint = joints_[j];
        const double unit = joint.turns ? radians : 1.0;
        states_[j] = {unit * joint.motion->position_deg[k], unit * joint.motion->velocity_deg_s[k],
                      unit * joint.motion->acceleration_deg_s2[k], joint.turns ? joint.cosine[k] : 1.0,
                      joint.turns ? joint.sine[k] : 0.0};
    }
    return states_;
}

}  // namespace ripplenotch
