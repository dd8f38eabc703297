// SPDX-License-Identifier: MIT
#pragma once
// Speed and acceleration at a sample from the logged values about it: the polynomial that fits the velocities
// of a window, and, where they are trusted, its positions too.

#include <span>
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

// Logs that lost rows here and there: an effect that uses earlier samples, a delay or a lag, has to know
// which of them is missing.

/// Position of each sample on a clock without gaps, in samples from the first: whole numbers that increase.
/// Empty where no row is missing. Single stamps may be off by nearly half a step: the clock common to all
/// stamps decides. A gap of more than a few samples does not count as lost rows and is one step, as
/// everywhere. `step_s` is set to the step of that clock.
[[nodiscard]] std::vector<std::size_t> places_of_rows(std::span<const double> time_s, double& step_s);

/// A signal known at these positions as one at every position: missing samples are on the cubic through two
/// samples to each side.
[[nodiscard]] std::vector<double> with_lost_rows(std::span<const double> values,
                                                 std::span<const std::size_t> places);

/// Runs act(values, sample rate in Hz) on a signal along these times, with lost rows filled in.
template <class Act>
void on_whole_clock(std::span<const double> time_s, double mean_rate_hz, std::span<double> values,
                    const Act& act) {
    double step_s = 0.0;
    const std::vector<std::size_t> places = places_of_rows(time_s, step_s);
    if (places.empty()) {
        act(values, mean_rate_hz);
        return;
    }
    std::vector<double> whole = with_lost_rows(values, places);
    act(std::span<double>(whole), 1.0 / step_s);
    for (std::size_t k = 0; k < values.size(); ++k) values[k] = whole[places[k]];
}

}  // namespace ripplenotch
