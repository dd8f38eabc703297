// SPDX-License-Identifier: MIT
#pragma once
// Knowledge of values that belong together as knowledge of as many others that do not.

#include "arm/fit/ridge.hpp"
#include "core/matrices/factorisations.hpp"
#include "ripplenotch/arm/arm_fit.hpp"

namespace ripplenotch {

/// With precision = L L', z = L' x has the covariance 1. Scaled, or the smallest inertia would be lost in
/// rounding relative to the largest mass: z = L' S x, where the scaled precision is S^-1 precision S^-1.
class Parting {
  public:
    explicit Parting(const ArmJointFit& own) : own_(own) {
        const auto n = static_cast<Eigen::Index>(own.mean.size());
        const Eigen::MatrixXd precision = Eigen::Map<const Eigen::MatrixXd>(own.precision.data(), n, n);
        scale_ = precision.diagonal().cwiseSqrt();
        const Eigen::VectorXd inverse = scale_.cwiseInverse();
        Eigen::MatrixXd scaled = inverse.asDiagonal() * precision * inverse.asDiagonal();
        scaled.diagonal().array() += rounding_of_definite;
        lower_ = DefiniteFactors(scaled).lower();
    }

    /// The prior mean, in the transformed coordinates.
    [[nodiscard]] Eigen::VectorXd of_values() const {
        const auto n = static_cast<Eigen::Index>(own_.mean.size());
        const Eigen::VectorXd mean = Eigen::Map<const Eigen::VectorXd>(own_.mean.data(), n);
        return lower_.transpose() * scale_.cwiseProduct(mean);
    }
    /// The values that belong together again.
    [[nodiscard]] Eigen::VectorXd values_of(const Eigen::VectorXd& parted) const {
        const Eigen::VectorXd scaled = lower_.transpose().triangularView<Eigen::Upper>().solve(parted);
        return scaled.cwiseQuotient(scale_);
    }
    /// A row of columns, in place: columns L'^-1.
    void part(Eigen::VectorXd& row) const {
        row = row.cwiseQuotient(scale_);
        lower_.triangularView<Eigen::Lower>().solveInPlace(row);
    }

  private:
    const ArmJointFit& own_;
    Eigen::VectorXd scale_;
    Eigen::MatrixXd lower_;
};

}  // namespace ripplenotch
