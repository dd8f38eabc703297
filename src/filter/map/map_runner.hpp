// SPDX-License-Identifier: MIT
#pragma once
// A map along a log, sample by sample.

#include <complex>
#include <optional>
#include <vector>

#include "ripplenotch/design/ripple_map.hpp"

namespace ripplenotch {

/// A map that depends on the temperature, at this one, held where none was seen: a map that does not, with a
/// part added to the amplitudes at every speed.
[[nodiscard]] RippleMap at_temperature(const RippleMap& map, double degc);

/// The map counts its angles from position 0. Without allocation after construction.
class MapRunner {
  public:
    /// `warming`: the same map at any temperature, for rows that tell theirs.
    explicit MapRunner(RippleMap map, std::optional<RippleMap> warming = std::nullopt);

    /// Goes to the joint's temperature; a thousandth of a degree counts. Nothing where the map does not
    /// follow.
    void warm(double degc) noexcept;

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
    std::optional<RippleMap> warming_;
    std::optional<double> degc_;  ///< that the map is at, once a row has told one
    std::vector<double> weights_;
    std::vector<std::complex<double>> amplitudes_;
};

}  // namespace ripplenotch
