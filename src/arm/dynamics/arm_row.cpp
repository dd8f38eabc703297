// SPDX-License-Identifier: MIT
#include "arm/dynamics/arm_row.hpp"

#include <algorithm>

#include "ripplenotch/arm/arm_dynamics.hpp"

namespace ripplenotch {

using namespace space;

ArmRow::ArmRow(const Chain& chain) : gravity_m_s2_(chain.gravity_m_s2) {
    for (const ChainJoint& joint : chain.joints) {
        const Rotation k = crossing(joint.axis);
        links_.push_back({.origin_m = joint.origin_m,
                          .axis = joint.axis,
                          .turns = joint.kind == JointKind::revolute,
                          .still = joint.rotation,
                          .by_sine = times(joint.rotation, k),
                          .by_versed = times(joint.rotation, times(k, k))});
    }
}

// From the base outward, each link's motion in its own frame. The base lies still and is lifted against
// gravity, which brings the weight of every link.
void ArmRow::move(std::span<const JointState> states) {
    Vector3 speed{}, acceleration{}, lift = -1.0 * gravity_m_s2_;
    for (std::size_t i = 0; i < links_.size(); ++i) {
        Link& link = links_[i];
        const JointState& state = states[i];
        link.rotation = link.still;
        link.place_m = link.origin_m;
        if (link.turns) {
            const double versed = 1.0 - state.cosine;
            for (std::size_t e = 0; e < 9; ++e)
                link.rotation[e] += state.sine * link.by_sine[e] + versed * link.by_versed[e];
        } else {
            link.place_m = link.place_m + state.position * outward(link.still, link.axis);
        }
        const Vector3 carried =
            lift + cross(acceleration, link.place_m) + cross(speed, cross(speed, link.place_m));
        link.speed = inward(link.rotation, speed);
        link.acceleration = inward(link.rotation, acceleration);
        link.lift = inward(link.rotation, carried);
        const Vector3 own = state.velocity * link.axis, change = state.acceleration * link.axis;
        if (link.turns) {
            link.acceleration = link.acceleration + change + cross(link.speed, own);
            link.speed = link.speed + own;
        } else {
            link.lift = link.lift + change + 2.0 * cross(link.speed, own);
        }
        speed = link.speed;
        acceleration = link.acceleration;
        lift = link.lift;
    }
}

// The torque is what the joint's axis, as a screw (turn, shift) carried out to each link, sees of the link's
// moment and force; that is the inward recursion read from the other end.
void ArmRow::torque_of(std::size_t joint, std::span<double> row) const {
    std::fill(row.begin(), row.end(), 0.0);
    Vector3 turn{}, shift{};
    (links_[joint].turns ? turn : shift) = links_[joint].axis;
    for (std::size_t j = joint; j < links_.size(); ++j) {
        const Link& link = links_[j];
        if (j > joint) {
            shift = inward(link.rotation, shift + cross(turn, link.place_m));
            turn = inward(link.rotation, turn);
        }
        const Vector3 &w = link.speed, &dw = link.acceleration, &a = link.lift;
        double* const at = row.data() + values_of_a_link * j;
        at[0] = dot(shift, a);
        const Vector3 first = cross(shift, dw) + dot(shift, w) * w + (-dot(w, w)) * shift + cross(a, turn);
        std::copy(first.begin(), first.end(), at + 1);
        const Vector3 gyration = cross(turn, w);
        const auto product = [&](std::size_t x, std::size_t y) {
            return turn[x] * dw[y] + gyration[x] * w[y];
        };
        at[4] = product(0, 0);
        at[5] = product(0, 1) + product(1, 0);
        at[6] = product(0, 2) + product(2, 0);
        at[7] = product(1, 1);
        at[8] = product(1, 2) + product(2, 1);
        at[9] = product(2, 2);
    }
}

}  // namespace ripplenotch
