// SPDX-License-Identifier: MIT
#pragma once
#include <span>

namespace ripplenotch {

struct StepSums {
    double shortest_s, longest_s;
    double squares;  ///< of the steps about the usual one
};

/// Of two times or more.
[[nodiscard]] StepSums sum_up_steps(std::span<const double> time_s, double usual_s) noexcept;

}  // namespace ripplenotch
