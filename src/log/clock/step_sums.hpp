// SPDX-License-Identifier: MIT
#pragma once
#include <span>

namespace ripplenotch {

/// Neither is more than `factor` times the other.
[[nodiscard]] inline bool within_factor(double a, double b, double factor) {
    return a <= factor * b && b <= factor * a;
}

struct StepSums {
    double shortest_s, longest_s;
    double squares;  ///< of the steps about the usual one
};

/// Of two times or more.
[[nodiscard]] StepSums sum_up_steps(std::span<const double> time_s, double usual_s) noexcept;

}  // namespace ripplenotch
