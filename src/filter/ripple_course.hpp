// SPDX-License-Identifier: MIT
#pragma once
// How a ripple's amplitude runs along a log: decided by what windows that were held out say.

#include <string_view>
#include <vector>

#include "filter/ripple_windows.hpp"

namespace ripplenotch {

/// How an order's amplitude is taken to run along the log, simplest first.
enum class Course { nothing, constant, by_direction, by_speed, local };
[[nodiscard]] std::string_view course_name(Course course);

struct CourseScore {
    Course course = Course::nothing;
    double left =
        1.0;  ///< ripple power that the other windows do not foretell, over that of no ripple at all
};

/// Tries every course on one order: each window is foretold from the others, and what is left of its
/// amplitude, weighted by how well it is known, is the score. The lowest wins; a simpler one does unless it
/// is worse by 5 %. Afterwards `amplitudes[order]` of every window holds what the winner takes it to be, the
/// window's own included.
[[nodiscard]] CourseScore choose_course(std::vector<RippleWindow>& windows, std::size_t order);

}  // namespace ripplenotch
