// SPDX-License-Identifier: MIT
#pragma once
// A map along a log, sample by sample.

#include <complex>
#include <vector>

#include "ripplenotch/design/ripple_map.hpp"

namespace ripplenotch {

/// The map counts its angles from position 0. Without allocation after construction.
class MapRunner {
  public:
    explicit MapRunner(RippleMap map);

    /// Goes to a joint's speed, motor angle and torque.
    void at(double speed_deg_s, double motor_turns, double torque_nm) noexcept;
    /// Of an order there: cosine and sine part, Nm.
    [[nodiscard]] std::complex<double> amplitude(std::size_t order) const noexcept {
        return amplitudes_[order];
    }
    /// What the map says of the torque there. Orders near half the sample rate are let go.
    [[nodiscard]] double ripple(double motor_turns, double step_turns) const noexcept;
    [[nodiscard]] const RippleMap& map() const noexcept { return map_; }

  private:
    RippleMap map_;
    std::vector<double> weights_;
    std::vector<std::complex<double>> amplitudes_;
};

}  // namespace ripplenotch
