// SPDX-License-Identifier: MIT
#pragma once
// What each method makes of a log whose true torque is known, in bounded memory.

#include <span>
#include <string>
#include <vector>

#include "ripplenotch/core/trace.hpp"
#include "ripplenotch/evaluate/comparison.hpp"
#include "ripplenotch/figure/figure.hpp"
#include "ripplenotch/figure/min_max.hpp"

namespace ripplenotch {

class ComparedCourse {
  public:
    /// As ComparedLog::watch calls it. `truth_nm` has a value for each row of the block.
    void add(std::size_t method, const TraceView& block, std::span<const double> out_nm,
             std::span<const double> truth_nm);

    [[nodiscard]] bool empty() const { return methods_.empty(); }

    /// Panels: the torque of each method beside the true one, and what it is off by. Names carry the rms
    /// error of the comparison's figures.
    [[nodiscard]] Figure figure(const std::string& source, const Comparison& comparison) const;

  private:
    struct Course {
        MinMaxCourse torque, error;
    };
    std::vector<Course> methods_;
    MinMaxCourse truth_;
};

}  // namespace ripplenotch
