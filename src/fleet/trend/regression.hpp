// SPDX-License-Identifier: MIT
#pragma once
// Internal: weighted least squares of a series on a few columns, and what one more column would explain of
// what they leave.

#include <optional>
#include <span>
#include <vector>

namespace ripplenotch {

/// What one more column explains.
struct Extra {
    double size = 0.0;   ///< of the column
    double error = 0.0;  ///< standard error of it
    double t_squared = 0.0;
};

class Regression {
  public:
    /// `weights` multiply rows: 1 over a standard deviation, or in proportion to it. Columns that the ones
    /// before them nearly hold are left out. All as long as `value`.
    Regression(std::span<const double> value, std::span<const double> weights,
               const std::vector<std::vector<double>>& columns);

    [[nodiscard]] const std::vector<double>& residual() const { return residual_; }  ///< weighed
    [[nodiscard]] const std::vector<double>& weights() const { return weights_; }
    [[nodiscard]] double freedom() const;    ///< rows less columns
    [[nodiscard]] double deviation() const;  ///< rms of the weighed residual, by its freedom
    /// What is left of a column beside the others, weighed.
    [[nodiscard]] std::vector<double> beside(std::span<const double> column) const;
    /// Takes the columns out of weighed numbers.
    void project(std::vector<double>& weighed) const;
    /// Empty where less than a twentieth of the column is left beside the others.
    [[nodiscard]] std::optional<Extra> extra(std::span<const double> column) const;
    /// Value of the first column, where all others are 0.
    [[nodiscard]] double first_value() const { return first_value_; }

  private:
    std::vector<double> weights_, residual_;
    std::vector<std::vector<double>> basis_;
    double first_value_ = 0.0;
};

}  // namespace ripplenotch
