// SPDX-License-Identifier: MIT
#pragma once
// One sample of an arm: how its links move, and what a value of a link is to the torque of a joint.

#include <span>
#include <vector>

#include "arm/chain/space.hpp"

namespace ripplenotch {

/// A joint at one sample, in radians or metres, and the cosine and sine of its angle.
struct JointState {
    double position = 0.0, velocity = 0.0, acceleration = 0.0, cosine = 1.0, sine = 0.0;
};

class ArmRow {
  public:
    explicit ArmRow(const Chain& chain);

    /// How all links move; one state a joint.
    void move(std::span<const JointState> states);
    /// Ten entries a link of the chain; those of links before `joint` are 0.
    void torque_of(std::size_t joint, std::span<double> row) const;

  private:
    struct Link {
        Vector3 origin_m, axis;
        bool turns;
        Rotation still, by_sine, by_versed;  ///< rotation = still + sine by_sine + (1 - cosine) by_versed
        // At the sample in hand, in the link's own frame but for `rotation` and `place_m`, which are in that
        // of the link before.
        Rotation rotation = space::unturned;
        Vector3 place_m{}, speed{}, acceleration{}, lift{};
    };
    std::vector<Link> links_;
    Vector3 gravity_m_s2_;
};

}  // namespace ripplenotch
