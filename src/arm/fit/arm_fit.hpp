// SPDX-License-Identifier: MIT
#pragma once
#include <span>
#include <vector>

#include "arm/dynamics/arm_dynamics.hpp"
#include "core/matrices/linear_algebra.hpp"
#include "ripplenotch/arm/arm_fit.hpp"

namespace ripplenotch {

// The torque of one joint per unit of every value, sample by sample: links, rotor, friction.

/// The number of values of a joint: rotor, then the nuisance parameters.
inline constexpr std::size_t values_of_a_joint = 1 + values_beside_arm;

/// Friction terms of an arm fit at one speed: the side of the motion, and the low-speed (Stribeck) part.
struct FrictionBeside {
    double side, stribeck;
};
[[nodiscard]] FrictionBeside friction_beside(double speed_deg_s);
/// A joint's speed as these shapes take it: of a prismatic joint, whose speed is in metres, that of a turn on
/// 0.1 m.
[[nodiscard]] double deg_s_of(JointKind kind);

class ArmRows {
  public:
    /// `friction`: the motions whose speed friction sees. All must outlive this.
    ArmRows(const Chain& chain, std::span<const Motion> motions, std::span<const Motion> friction,
            std::size_t joint);

    [[nodiscard]] std::size_t size() const { return states_.size(); }
    /// Ten a link and values_of_a_joint.
    [[nodiscard]] std::size_t values() const { return links_ + values_of_a_joint; }
    void at(std::size_t sample, std::span<double> row);

  private:
    std::size_t links_, joint_;
    ArmStates states_;
    ArmRow arm_;
    const Motion& friction_;
    double unit_;
};

// A log as sums of squares, a fifth at a time: all that least squares need, whatever the pull.

struct FoldSums {
    Eigen::MatrixXd rows_by_rows;  ///< products of the columns with each other
    Eigen::VectorXd rows_by_torque;
    double torque_by_torque = 0.0;
    double count = 0.0;

    explicit FoldSums(std::size_t values = 0);
    void add(std::span<const double> row, double torque_nm);
    void add(const FoldSums& other);
    void complete();  ///< fills in the half that add(row) leaves out
    /// Sum of squares that these values leave.
    [[nodiscard]] double left(const Eigen::VectorXd& values) const;
};

inline constexpr std::size_t arm_folds = 5;  // chosen, not derived: parts that are left out in turn

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

/// `use` has an entry per row.
[[nodiscard]] JointSums sums_of(ArmRows& rows, const TraceView& log, std::size_t joint, Seconds window,
                                const FitRows& chosen, const std::vector<bool>& use);

}  // namespace ripplenotch
