// SPDX-License-Identifier: MIT
#pragma once
// Methods side by side: frequency responses, a step and a ramp.

#include <span>
#include <string>
#include <vector>

#include "ripplenotch/core/trace.hpp"
#include "ripplenotch/evaluate/comparison.hpp"
#include "ripplenotch/figure/figure.hpp"
#include "ripplenotch/figure/min_max.hpp"

namespace ripplenotch {

// The outputs of the methods for a log whose true torque is known, in bounded memory.

class ComparedCourse {
  public:
    /// As ComparedLog::watch calls it. `truth_nm` has a value for each row of the block.
    void add(std::size_t method, const TraceView& block, std::span<const double> out_nm,
             std::span<const double> truth_nm);

    [[nodiscard]] bool empty() const { return methods_.empty(); }

    /// Panels: the torque of each method with the true one, and its error. Names carry the rms error of the
    /// comparison's figures.
    [[nodiscard]] Figure figure(const std::string& source, const Comparison& comparison) const;

  private:
    struct Course {
        MinMaxCourse torque, error;
    };
    std::vector<Course> methods_;
    MinMaxCourse truth_;
};

/// Magnitude, phase and group delay of the linear filter that each method is at the comparison's speed, and
/// its output for a step and a ramp. Runs the filters on signals of its own, as Bench does.
[[nodiscard]] Figure comparison_figure(const Comparison& comparison, std::span<const Contender> contenders);

}  // namespace ripplenotch
