// SPDX-License-Identifier: MIT
#pragma once
// Least squares of several joints that share the links and have each its own values, drawn towards 0.

#include <optional>
#include <span>
#include <vector>

#include "arm/fit/arm_fit.hpp"

namespace ripplenotch {

class ArmRidge {
  public:
    /// `size` of the arm, 1 up to 100 Nm: a larger one has heavier links.
    ArmRidge(std::size_t links, const std::vector<JointSums>& joints, double size);

    /// Values of each joint's rows (links, then its own) that leave least of the smoothed torque. `noise_nm`:
    /// by joint. `left_out`: a fold that does not count.
    [[nodiscard]] std::vector<Eigen::VectorXd> solve(double pull, std::span<const double> noise_nm,
                                                     std::optional<std::size_t> left_out = {}) const;

    struct Errors {
        std::vector<double> smoothed_nm, logged_nm;  ///< rms by joint
        [[nodiscard]] double smoothed_mean() const;  ///< geometric
        [[nodiscard]] double logged_mean() const;
    };
    /// The residual of each fifth with the values fitted without it.
    [[nodiscard]] Errors left_out_errors(double pull, std::span<const double> noise_nm) const;

    /// How far a value may go from 0 at a pull of 1.
    [[nodiscard]] double reach(std::size_t value) const;
    /// The information of joint `j` (in the order given) on the links, its own values being free: the matrix
    /// and the right side of its normal equations.
    struct Word {
        Eigen::MatrixXd matrix;
        Eigen::VectorXd side;
    };
    [[nodiscard]] Word word_of(std::size_t j, double noise_nm) const;

  private:
    std::size_t links_;  ///< ten a link
    const std::vector<JointSums>& joints_;
    double size_;
    std::vector<std::vector<FoldSums>> without_;  ///< by joint and fold left out; the last: none
};

/// Rounding error of a matrix whose diagonal is 1.
inline constexpr double rounding_of_definite = 1e-12;

}  // namespace ripplenotch
