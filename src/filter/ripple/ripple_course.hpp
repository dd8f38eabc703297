// SPDX-License-Identifier: MIT
#pragma once
// How a ripple's amplitude runs along a log: decided by what windows that were held out say.

#include <string_view>
#include <vector>

#include "filter/ripple/ripple_windows.hpp"

namespace ripplenotch {

/// How an order's amplitude is taken to run along the log, simplest first.
enum class Course { nothing, constant, by_direction, by_speed, local };
[[nodiscard]] std::string_view course_name(Course course);

struct CourseScore {
    Course course = Course::nothing;
    double error = 1.0;  ///< power that the course is wrong by, over that of the ripple
};

/// Tries every course on one order. Each window is foretold from the others, and what is left of its
/// amplitude beyond the background, weighted by how well it is known, is the course's error; that of `local`,
/// which takes the window's own amplitude, is the background. The least wins; a simpler one does unless it is
/// worse by 5 % and by 1 % of the ripple's power. Afterwards `amplitudes[order]` of every window holds what
/// the winner takes it to be.
[[nodiscard]] CourseScore choose_course(std::vector<RippleWindow>& windows, std::size_t order);

}  // namespace ripplenotch
