// SPDX-License-Identifier: MIT
#pragma once
// Ripple of each order in every few motor turns of a log, by least squares along with a smooth torque.

#include <complex>
#include <cstddef>
#include <span>
#include <vector>

#include "filter/ripple_keys.hpp"

namespace ripplenotch {

/// Where a sample stands: motor angle, and how far the motor has turned since the log began, back and forth
/// added up. A gap in time puts the two sides far apart.
class MotorPath {
  public:
    explicit MotorPath(const MotorAngle& angle) : angle_(angle) {}
    void next(double velocity_deg_s, const double* position_deg) noexcept;
    void restart() noexcept;
    [[nodiscard]] double turns() const noexcept { return angle_.turns(); }
    [[nodiscard]] double step_turns() const noexcept { return angle_.step_turns(); }
    [[nodiscard]] double travelled() const noexcept { return travelled_; }

  private:
    MotorAngle angle_;
    double travelled_ = 0.0;
};

/// Ripple amplitudes in one window: ripple = Re(value exp(-i n theta)), that is cosine + i sine.
struct RippleWindow {
    double middle = 0.0;         ///< MotorPath::travelled
    double length = 0.0;         ///< in motor turns
    double speed_turns_s = 0.0;  ///< signed mean speed of the motor
    double variance = 0.0;       ///< variance of each part of each amplitude, by the fit's own residual
    std::vector<std::complex<double>> amplitudes;
    /// Per order: mean square of the same fit half an order to its sides, where no ripple is.
    std::vector<double> background;
    double middle_turns = 0.0;  ///< mean motor angle
};

struct RippleWindowRule {
    double turns = 2.5, fewest_turns = 2.0;
    double longest_s = 2.0;  ///< a cubic follows the torque no longer
};

/// Cuts a log into half-overlapping windows of `turns` motor turns in one direction and fits a cubic in time
/// and all orders, the middle counting most.
class RippleWindows {
  public:
    RippleWindows(std::vector<double> orders, double sample_rate_hz, RippleWindowRule rule);
    void add(const MotorPath& path, double torque_nm);
    void split();  ///< what comes next does not continue the window
    /// Closes the last window and gives up all of them.
    [[nodiscard]] std::vector<RippleWindow> finish();

  private:
    void begin(const MotorPath& path);
    void close();
    void keep_second_half();
    [[nodiscard]] double background(std::size_t order, std::span<const double> residual,
                                    std::span<const double> weight) const;

    std::vector<double> orders_;
    double rate_hz_;
    RippleWindowRule rule_;
    std::vector<double> turns_, torque_nm_;  ///< samples of the current window; turns from its first row
    double first_turns_ = 0.0, first_travelled_ = 0.0, furthest_ = 0.0;
    std::vector<RippleWindow> windows_;
};

}  // namespace ripplenotch
