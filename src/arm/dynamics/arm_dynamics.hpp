// SPDX-License-Identifier: MIT
#pragma once
#include <span>
#include <vector>

#include "arm/chain/chain.hpp"
#include "ripplenotch/model/effect.hpp"

namespace ripplenotch {

// One sample of an arm: how its links move, and the torque of a joint per unit of a link's value.

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
        // At the current sample, in the link's own frame except `rotation` and `place_m`, which are in that
        // of the link before.
        Rotation rotation = space::unturned;
        Vector3 place_m{}, speed{}, acceleration{}, lift{};
    };
    std::vector<Link> links_;
    Vector3 gravity_m_s2_;
};

// The samples of all joints, one after another.

class ArmStates {
  public:
    /// Motions in the order of the chain, which must outlive this. Throws UsageError where they are not one a
    /// joint and of equal length.
    ArmStates(const Chain& chain, std::span<const Motion> motions);

    [[nodiscard]] std::size_t size() const { return samples_; }
    /// Valid until the next call.
    [[nodiscard]] std::span<const JointState> at(std::size_t sample);

  private:
    struct Joint {
        const Motion* motion;
        bool turns;
        std::vector<double> cosine, sine;
    };
    std::size_t samples_ = 0;
    std::vector<Joint> joints_;
    std::vector<JointState> states_;
};

}  // namespace ripplenotch
