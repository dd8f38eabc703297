// SPDX-License-Identifier: MIT
#pragma once
#include <optional>
#include <span>
#include <vector>

#include "core/matrices/linear_algebra.hpp"
#include "ripplenotch/core/trace.hpp"
#include "ripplenotch/diagnose/setup.hpp"

namespace ripplenotch {

// Least squares by blocks of rows: the sums of each block separately, so that any of them can be left out.

class BlockedSquares {
  public:
    /// `block`: of each row. The last block is the greatest number.
    BlockedSquares(const std::vector<std::vector<double>>& columns, std::span<const double> target,
                   std::span<const std::size_t> block);

    [[nodiscard]] std::size_t blocks() const { return sums_.size(); }
    [[nodiscard]] const Eigen::VectorXd& values() const { return values_; }
    /// Values by which the first columns, so many, are nearest to the target without one block.
    [[nodiscard]] const std::vector<Eigen::VectorXd>& values_without() const { return without_; }
    /// Standard error of a value by the delete-a-block jackknife (Efron and Tibshirani 1993, chapter 11).
    [[nodiscard]] double jackknife_error(std::size_t value) const;
    /// Sums of squares that are left of each block by the values found without it.
    [[nodiscard]] std::vector<double> held_out() const;
    /// The same by the values found with it.
    [[nodiscard]] std::vector<double> left() const;

  private:
    struct Sums {
        Eigen::MatrixXd products;
        Eigen::VectorXd side;
        double squares = 0.0;
        [[nodiscard]] double left(const Eigen::VectorXd& values) const;
    };
    std::vector<Sums> sums_;
    Eigen::VectorXd values_;
    std::vector<Eigen::VectorXd> without_;
};

/// Numbers of blocks for rows of which each has so much weight: the same weight in each, in the order of the
/// rows.
[[nodiscard]] std::vector<std::size_t> equal_blocks(std::span<const double> weight, std::size_t blocks);

// What a measured torque may have that a simulation lacks, over the window of an alignment: columns of
// nuisance parameters.

struct NuisanceChoice {
    bool friction = false, inertia = false, ripple = false, gravity = false, load = false;
};

class NuisanceColumns {
  public:
    struct Window {
        std::span<const double> at_s;
        double smoothing_s;
    };
    /// Along the motion of the log.
    NuisanceColumns(const TraceView& log, std::optional<GearRatio> gear_ratio,
                    const AlignmentOptions& options, const Window& window);

    /// An offset, and the chosen ones of: friction (Coulomb of two widths, viscous), the acceleration, cosine
    /// and sine of the position, ripple of orders 1 and 2 whose amplitude is affine in the speed, friction
    /// that grows with the measured torque and hysteresis (Dahl's, of 2 deg).
    [[nodiscard]] std::vector<std::vector<double>> of(const NuisanceChoice& choice) const;
    [[nodiscard]] bool has_position() const { return !gravity_.empty(); }
    [[nodiscard]] bool has_velocity() const { return !friction_.empty(); }

  private:
    std::size_t rows_;
    std::vector<std::vector<double>> friction_, inertia_, gravity_, ripple_, load_;
};

}  // namespace ripplenotch
