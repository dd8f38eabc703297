// SPDX-License-Identifier: MIT
#pragma once
// Speed and acceleration at a sample from the logged values about it: the polynomial that fits the velocities
// of a window, and, where they are trusted, its positions too.

#include <vector>

#include "ripplenotch/core/trace.hpp"

namespace ripplenotch {

/// rms of the noise on one sample.
struct MotionNoise {
    double velocity_deg_s = 1.0;
    double position_deg = 0.0;  ///< 0: the position is ignored
};

struct SampleWindow {
    std::size_t first, end;  ///< samples [first, end)
};

struct LocalMotion {
    double velocity_deg_s, acceleration_deg_s2;
};

/// Least squares by a cubic velocity, whose integral is a quartic in position; each sample weighs by its
/// noise.
class LocalFit {
  public:
    LocalFit(const TraceView& log, MotionNoise noise);

    [[nodiscard]] LocalMotion at(std::size_t k, SampleWindow window);
    /// rms error of the velocity at sample k due to noise, deg/s.
    [[nodiscard]] double velocity_error(std::size_t k, SampleWindow window);

    static constexpr std::size_t fewest_samples = 5;  ///< a cubic and one more

  private:
    void weigh(std::size_t k, SampleWindow window);
    void sum_up(std::size_t k, SampleWindow window);

    TraceView log_;
    MotionNoise noise_;
    bool uniform_;
    // For times that are not uniform: the result for the last sample. Each window has times of its own there,
    // and factors would cost more than they save.
    std::size_t summed_ = 0, summed_end_ = 0;  // no window ends at 0
    LocalMotion found_{0.0, 0.0};
    // Factors of the samples of the window weighed last, of velocities and of positions, for the velocity and
    // for the acceleration.
    std::size_t before_ = 0, after_ = 0;
    std::vector<double> velocity_by_velocity_, velocity_by_position_, acceleration_by_velocity_,
        acceleration_by_position_;
    std::vector<double> turned_deg_;  ///< positions of the window, from that of its sample
    double variance_ = 0.0;
};

/// rms of the white noise of a signal, whatever moves slowly: from fourth differences.
[[nodiscard]] double sample_noise(std::span<const double> values);

}  // namespace ripplenotch
