// SPDX-License-Identifier: MIT
#pragma once
// The samples of all joints, one after another.

#include <span>
#include <vector>

#include "arm/dynamics/arm_row.hpp"
#include "ripplenotch/model/effect.hpp"

namespace ripplenotch {

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
