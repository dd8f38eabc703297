// SPDX-License-Identifier: MIT
#pragma once
// A map beneath a Kalman filter of the ripple: the filter follows what the ripple is beside the map. Where
// the motor's angle is not known, the map is laid over what the filter found in the first turn.

#include <cstddef>
#include <optional>
#include <vector>

#include "filter/map/map_runner.hpp"
#include "filter/ripple/motor_angle.hpp"
#include "filter/ripple/ripple_kalman.hpp"

namespace ripplenotch {

/// The largest amplitude that the map has for an order, Nm: of any speed and direction, harmonics of the
/// joint's turn added.
[[nodiscard]] double largest_amplitude(const RippleMap& map, std::size_t order);

class MapMean {
  public:
    /// The map counts its angles from position 0; `noise_nm` is the unit of the filter.
    MapMean(RippleMap map, double noise_nm, std::optional<RippleMap> warming = std::nullopt);
    /// Before ripple() of a row that tells the joint's temperature.
    void warm(double degc) noexcept { runner_.warm(degc); }

    /// Before the first sample of a run. One that seeks says 0 until the motor has turned once.
    void restart(bool seek) noexcept;
    /// What the map says at this sample, Nm; to be taken off before the filter sees it.
    [[nodiscard]] double ripple(double speed_deg_s, double torque_nm, const MotorAngle& angle) noexcept;
    /// After the filter has seen a sample: once the motor has turned, finds where the map's angle is 0 and
    /// hands the filter what is beside the map from there on.
    void seek(RippleKalman& filter, const MotorAngle& angle) noexcept;
    [[nodiscard]] bool seeks() const noexcept { return seeks_; }

  private:
    [[nodiscard]] double misfit(double shift_turns) const noexcept;

    struct Found {
        double cosine, sine, weight;
    };
    MapRunner runner_;
    double noise_nm_;
    std::vector<Found> found_;  ///< by the filter, by order
    double shift_turns_ = 0.0, turned_ = 0.0;
    bool seeks_ = false;
};

}  // namespace ripplenotch
