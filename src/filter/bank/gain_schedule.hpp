// SPDX-License-Identifier: MIT
#pragma once
// Settled gains of the ripple's Kalman filter over motor speed, worked out once.

#include <span>
#include <vector>

#include "filter/ripple/ripple_kalman.hpp"

namespace ripplenotch {

/// Gains in the frame of ripple_rotation, linear between eight speeds an octave.
class GainSchedule {
  public:
    explicit GainSchedule(const RippleModel& model);

    /// The gain at `step_turns` motor turns a sample, either direction, into `gain` (RippleModel::states
    /// entries). At standstill the ripple's is 0 and the torque's that of a filter without ripple.
    void at(double step_turns, std::span<double> gain) const noexcept;

  private:
    std::size_t states_;
    std::vector<double> standing_;
    std::vector<double> gains_;  ///< states_ entries a speed, slowest first
};

/// What GainSchedule::at gives, where one speed is all that is asked: of the hundred or so that a schedule
/// holds, only the two beside it are worked out.
[[nodiscard]] std::vector<double> scheduled_gain(const RippleModel& model, double step_turns);

}  // namespace ripplenotch
