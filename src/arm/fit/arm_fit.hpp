// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "arm/chain/chain.hpp"
#include "core/matrices/linear_algebra.hpp"
#include "ripplenotch/arm/arm_fit.hpp"
#include "ripplenotch/core/quantity.hpp"
#include "ripplenotch/model/effect.hpp"

namespace ripplenotch {

// One sample of an arm: how its links move, and the torque of a joint per unit of a link's value.

/// A joint at one sample, in radians or metres, and the cosine and sine of its angle.
struct JointState {
    double position = 0.0, velocity = 0.0, acceleration = 0.0, cosine = 1.0, sine = 0.0;
};

class ArmRow {
  public:
    explicit ArmRow(const Chain& chain);

    /// How all links move; one state a joint.
    void move(std::span<const JointState> states);
    /// Ten entries a link of the chain; those of links before `joint` are 0.
    void torque_of(std::size_t joint, std::span<double> row) const;

  private:
    struct Link {
        Vector3 origin_m, axis;
        bool turns;
        Rotation still, by_sine, by_versed;  ///< rotation = still + sine by_sine + (1 - cosine) by_versed
        // At the current sample, in the link's own frame except `rotation` and `place_m`, which are in that
        // of the link before.
        Rotation rotation = space::unturned;
        Vector3 place_m{}, speed{}, acceleration{}, lift{};
    };
    std::vector<Link> links_;
    Vector3 gravity_m_s2_;
};

// The samples of all joints, one after another.

class ArmStates {
  public:
    /// Motions in the order of the chain, which must outlive this. Throws UsageError where they are not one a
    /// joint and of equal length.
    ArmStates(const Chain& chain, std::span<const Motion> motions);

    [[nodiscard]] std::size_t size() const { return samples_; }
    /// Valid until the next call.
    [[nodiscard]] std::span<const JointState> at(std::size_t sample);

  private:
    struct Joint {
        const Motion* motion;
        bool turns;
        std::vector<double> cosine, sine;
    };
    std::size_t samples_ = 0;
    std::vector<Joint> joints_;
    std::vector<JointState> states_;
};

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

// Least squares of several joints that share the links and have each its own values, drawn towards 0.

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
