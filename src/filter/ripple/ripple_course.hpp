// SPDX-License-Identifier: MIT
#pragma once
// The course of a ripple's amplitude along a log, selected by cross-validation over windows.

#include <complex>
#include <cstddef>
#include <span>
#include <string_view>
#include <vector>

#include "filter/ripple/ripple_keys.hpp"

namespace ripplenotch {

// Ripple of each order in every few motor turns of a log, by least squares along with a smooth torque.

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
    double torque_nm = 0.0;     ///< mean
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

/// How an order's amplitude is taken to run along the log, simplest first.
enum class Course { nothing, constant, by_direction, by_speed, local };
[[nodiscard]] std::string_view course_name(Course course);

struct CourseScore {
    Course course = Course::nothing;
    double error = 1.0;  ///< power that the course is wrong by, over that of the ripple
};

/// Tries every course on one order. Each window is predicted from the others, and the residual of its
/// amplitude beyond the background, weighted by its precision, is the course's error; that of `local`, which
/// takes the window's own amplitude, is the background. The least wins; a simpler one does unless it is worse
/// by 5 % and by 1 % of the ripple's power. Afterwards `amplitudes[order]` of every window holds the estimate
/// of the selected course.
[[nodiscard]] CourseScore choose_course(std::vector<RippleWindow>& windows, std::size_t order);

}  // namespace ripplenotch
