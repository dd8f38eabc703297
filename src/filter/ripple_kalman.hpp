// SPDX-License-Identifier: MIT
#pragma once
// A Kalman filter for torque and ripple together: torque and its rate, and for each order a cosine and a sine
// amplitude in the motor angle.

#include <cstddef>
#include <span>
#include <vector>

#include "ripplenotch/core/biquad.hpp"

namespace ripplenotch {

/// All in units of the sensor's noise, whose variance is 1 per sample.
struct RippleModel {
    std::vector<double> orders;
    double step_s = 0.0;
    double bandwidth_rad_s = 0.0;  ///< bandwidth of the torque: where its spectrum sinks below the noise
    double memory_turns = 0.0;     ///< turns of the motor over which an amplitude may change
    double jump = 0.0;          ///< surprise, in its own deviations, beyond which the torque jumped; 0: never
    double return_turns = 0.0;  ///< turns of the motor over which amplitudes decay towards 0; 0: never

    [[nodiscard]] std::size_t states() const { return 2 + 2 * orders.size(); }
    /// Increments by the torque's second derivative in one step: variances of torque and rate, and their
    /// covariance.
    struct TorqueNoise {
        double torque, cross, rate;
    };
    [[nodiscard]] TorqueNoise torque_noise() const noexcept;
    /// Variance of the torque's rate before the first sample.
    [[nodiscard]] double first_rate_variance() const noexcept;
    /// Increment of the variance of each amplitude in a step of this many motor turns.
    [[nodiscard]] double amplitude_noise(double step_turns) const noexcept;
    /// Share of an order that is modelled: 1, and less where it nears half the sample rate, beyond which it
    /// would be taken for torque.
    [[nodiscard]] double share(double order, double step_turns) const noexcept;
};

/// The prior of an order at the start.
struct AmplitudePrior {
    double cosine = 0.0, sine = 0.0;  ///< amplitudes in ripple = cosine cos(n theta) + sine sin(n theta)
    double deviation = 0.0;           ///< standard deviation of each
};

class GainSchedule;

/// The filter. With its exact gain, computed at every sample: m = 2 + 2 orders, about 1.5 m^2 + 6 m
/// multiplications and additions a sample, and a cosine and a sine per order. With a schedule of settled
/// gains, which must outlive it: about 6 m, and a logarithm; the covariance of the state is then not
/// available.
class RippleKalman {
  public:
    RippleKalman(RippleModel model, std::vector<AmplitudePrior> priors, GainSchedule* schedule = nullptr);

    /// The first sample, where the torque is anything at all: torque + ripple = 0 is what was measured.
    void start(double motor_turns);
    /// The same where the torque is known to be 0 at the first sample: all of `measured` is noise or ripple.
    void start_unloaded(double motor_turns, double measured);
    /// Torque estimate after the sample `measured`, at the motor angle `motor_turns`.
    double next(double measured, double motor_turns, double step_turns);

    [[nodiscard]] double torque() const noexcept { return x_[0]; }
    /// The amplitude of an order: cosine and sine part, and the variance of both together.
    [[nodiscard]] AmplitudePrior amplitude(std::size_t order) const noexcept;
    /// From now on the amplitudes are relative to these, and the caller subtracts them.
    void count_from(std::size_t order, double cosine, double sine) noexcept;
    [[nodiscard]] double ripple() const noexcept;  ///< at the last sample
    /// By how much the ripple's phase ran ahead of the angle in the last sample, in motor turns: mean over
    /// the orders whose amplitude is known to a third, 0 when none is.
    [[nodiscard]] double phase_advance_turns() const noexcept;

  private:
    void look(double motor_turns, double step_turns) noexcept;
    void predict(double step_turns) noexcept;
    void forget(double step_turns) noexcept;
    void update(double measured) noexcept;
    void update_by_schedule(double measured, double step_turns);

    RippleModel model_;
    std::vector<AmplitudePrior> priors_;
    GainSchedule* schedule_;
    std::size_t m_;
    RippleModel::TorqueNoise torque_noise_;
    std::vector<double> x_, p_, h_, ph_;  ///< p_ is m by m, row by row; ph_ the gain times `scale`
    double surprise_ = 0.0;               ///< innovation of the last sample, times the scale of ph_
    double settled_variance_ = 0.0;       ///< variance of the last measurement, by the schedule
};

/// The model at one constant speed in the frame that turns with the motor: torque, rate, then for each order
/// the ripple and its value a quarter period later.
struct RippleRotation {
    std::vector<double> step;  ///< m by m, row by row
    std::vector<double> seen;  ///< weight of each state in the measurement
};
[[nodiscard]] RippleRotation ripple_rotation(const RippleModel& model, double step_turns);

/// Gain at one constant speed once settled, in the frame that turns with the motor of ripple_rotation. Empty
/// where ripple and torque cannot be distinguished (at standstill).
[[nodiscard]] std::vector<double> settled_gain(const RippleModel& model, double step_turns);

// Settled gains of the ripple's Kalman filter over motor speed.

/// Gains in the frame of ripple_rotation, linear between eight speeds an octave, each computed when it is
/// first needed.
class GainSchedule {
  public:
    explicit GainSchedule(RippleModel model);

    /// The gain at `step_turns` motor turns a sample, either direction, into `gain` (RippleModel::states
    /// entries). At standstill the ripple's is 0 and the torque's that of a filter without ripple.
    void at(double step_turns, std::span<double> gain);

  private:
    RippleModel model_;
    std::vector<std::vector<double>> gains_;  ///< at standstill, then by speed; empty: not known yet
};

// The settled Kalman filter at one speed, written as second-order sections, so that delay and attenuation can
// be read off as for any other filter.

/// From the measured torque to the torque estimate, or to the measured torque less the ripple estimate. Gain
/// 1 at 0 Hz. `gain` is in the frame of ripple_rotation; empty at standstill, where ripple and torque cannot
/// be distinguished and the amplitudes do not change.
[[nodiscard]] Cascade settled_cascade(const RippleModel& model, double step_turns, std::vector<double> gain,
                                      bool minus_ripple);

}  // namespace ripplenotch
