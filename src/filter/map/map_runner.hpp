// SPDX-License-Identifier: MIT
#pragma once
// A map along a log, sample by sample: alone, or combined with a Kalman filter that follows the difference
// between the ripple and the map. Where the motor's angle is not known, the map is aligned with the ripple
// that the filter found in the first turn.

#include <complex>
#include <cstddef>
#include <string_view>
#include <vector>

#include "filter/map/map_settings.hpp"
#include "filter/ripple_kalman.hpp"
#include "filter/ripple_keys.hpp"

namespace ripplenotch {

/// The largest amplitude that the map has for an order, Nm: of any speed and direction, both combs
/// added.
[[nodiscard]] double largest_amplitude(const RippleMap& map, std::size_t order);

/// The map counts its angles from position 0. Without allocation after construction.
class MapRunner {
  public:
    explicit MapRunner(RippleMap map);

    /// Goes to a joint's speed and motor angle.
    void at(double speed_deg_s, double motor_turns) noexcept;
    /// The amplitude of an order there: cosine and sine part, Nm.
    [[nodiscard]] std::complex<double> amplitude(std::size_t order) const noexcept {
        return amplitudes_[order];
    }
    /// The ripple predicted by the map there. Orders near half the sample rate are ignored.
    [[nodiscard]] double ripple(double motor_turns, double step_turns) const noexcept;
    [[nodiscard]] const RippleMap& map() const noexcept { return map_; }

  private:
    RippleMap map_;
    std::vector<double> weights_;
    std::vector<std::complex<double>> amplitudes_;
};

class MapMean {
  public:
    /// `noise_nm` is the unit of the filter.
    MapMean(RippleMap map, double noise_nm);

    /// To be called before the first sample of a run. A map that seeks returns 0 until the motor has turned
    /// once.
    void restart(bool seek) noexcept;
    /// The ripple predicted by the map at this sample, Nm; to be subtracted before the filter receives the
    /// sample.
    [[nodiscard]] double ripple(double speed_deg_s, const MotorAngle& angle) noexcept;
    /// To be called after the filter has seen a sample: once the motor has turned, finds where the map's
    /// angle is 0 and lets the filter follow the residual of the map from there on.
    void seek(RippleKalman& filter, const MotorAngle& angle) noexcept;
    [[nodiscard]] bool seeks() const noexcept { return seeks_; }

  private:
    /// In units of the filter, of one order whose angle counts from `shift_turns`.
    [[nodiscard]] std::complex<double> shifted(std::size_t order, double shift_turns) const noexcept;
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

/// Watches the mean speed over each motor turn, which noise of the velocity or a single bad row does not
/// move, for how far beyond its logs a map is used.
class MapReach {
  public:
    /// Watches nothing where `settings` has no `fastest`, or beyond=hold.
    MapReach(std::string_view method, const Settings& settings, double gear_ratio, double sample_rate_hz);

    void restart() noexcept { turned_ = samples_ = 0.0; }
    /// Throws DataError, with both speeds, where the joint turns half as fast again as the map's logs did.
    void next(double step_turns) {
        if (!(fastest_deg_s_ > 0.0)) return;
        turned_ += step_turns;
        samples_ += 1.0;
        if (turned_ >= 1.0 || turned_ <= -1.0) judge();
    }

  private:
    void judge();

    std::string_view method_;
    double slowest_deg_s_ = 0.0, fastest_deg_s_ = 0.0;
    double deg_s_a_turn_a_sample_ = 0.0;
    double turned_ = 0.0, samples_ = 0.0;  ///< since the last motor turn
};

}  // namespace ripplenotch
