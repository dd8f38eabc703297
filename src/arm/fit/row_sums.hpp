// SPDX-License-Identifier: MIT
#pragma once
// A log as sums of squares, a fifth at a time: all that least squares need, whatever the pull.

#include <span>
#include <vector>

#include "arm/fit/arm_rows.hpp"
#include "core/matrices/linear_algebra.hpp"

namespace ripplenotch {

struct FoldSums {
    Eigen::MatrixXd rows_by_rows;  ///< of the columns with each other
    Eigen::VectorXd rows_by_torque;
    double torque_by_torque = 0.0;
    double count = 0.0;

    explicit FoldSums(std::size_t values = 0);
    void add(std::span<const double> row, double torque_nm);
    void add(const FoldSums& other);
    void complete();  ///< the half that add(row) leaves out
    /// Sum of squares that these values leave.
    [[nodiscard]] double left(const Eigen::VectorXd& values) const;
};

inline constexpr std::size_t arm_folds = 5;  // by hand: parts that are left out in turn

struct JointSums {
    std::size_t joint = 0;
    /// By fifths of the log. Smoothed: columns and torque pass the same window. As logged: neither.
    std::vector<FoldSums> smoothed, logged;
};

/// Rows of the fit: every so manyth of the log, a quarter of a window apart, that count.
struct FitRows {
    std::vector<std::size_t> centers;
    double step = 1.0;  ///< rows of the log between them
};
[[nodiscard]] FitRows fit_rows(const TraceView& log, Seconds window, const std::vector<bool>& use);

/// `use` has an entry per row.
[[nodiscard]] JointSums sums_of(ArmRows& rows, const TraceView& log, std::size_t joint, Seconds window,
                                const FitRows& chosen, const std::vector<bool>& use);

}  // namespace ripplenotch
