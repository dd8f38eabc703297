// SPDX-License-Identifier: MIT
#pragma once
// Least squares in which each value is drawn towards 0 as by a measurement of its own.

#include <limits>
#include <span>
#include <vector>

#include "core/matrices/factorisations.hpp"

namespace ripplenotch {

/// Deviation of a value of which nothing is known.
inline constexpr double any_size = std::numeric_limits<double>::infinity();

class Ridge {
  public:
    /// `columns` must outlive it, all of one length. `deviation`: of each value, infinity leaves it free.
    /// `noise`: rms of what the columns do not explain, against which deviations are weighed.
    Ridge(const std::vector<std::vector<double>>& columns, std::span<const double> deviation, double noise);

    [[nodiscard]] std::vector<double> solve(std::span<const double> target) const;
    /// Standard errors of the values, where what the columns do not explain is white and of rms `noise`.
    [[nodiscard]] std::vector<double> standard_errors() const;

  private:
    const std::vector<std::vector<double>>& columns_;
    double noise_;
    ScaledDefiniteFactors factored_;
};

}  // namespace ripplenotch
