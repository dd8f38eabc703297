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
    /// `target` less the columns times `values`.
    [[nodiscard]] std::vector<double> left(std::span<const double> target,
                                           const std::vector<double>& values) const;
    [[nodiscard]] std::vector<double> left(std::span<const double> target) const;
    /// The same of several targets.
    [[nodiscard]] std::vector<std::vector<double>> left(std::vector<std::vector<double>> targets) const;

  private:
    /// Of two targets what is left of them.
    void leave(std::vector<double>& one, std::vector<double>& other) const;
    [[nodiscard]] std::vector<double> values_of(Eigen::VectorXd products) const;

    const std::vector<std::vector<double>>& columns_;
    Eigen::VectorXd scale_;
    DefiniteFactors factored_;
};

}  // namespace ripplenotch
