// SPDX-License-Identifier: MIT
#pragma once
// The values of an arm's links from a log of its joints: all joints at once, together with friction, drawn
// towards 0 as far as cross-validation supports it.

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "ripplenotch/arm/chain.hpp"
#include "ripplenotch/core/quantity.hpp"
#include "ripplenotch/core/trace.hpp"
#include "ripplenotch/model/effect.hpp"
#include "ripplenotch/model/model.hpp"

namespace ripplenotch {

/// The joints of a chain in a log, in the order of the chain: rows of the same times, each with a position.
/// The torque of a joint without one may hold anything.
struct ArmLog {
    std::vector<TraceView> joints;
    std::vector<bool> has_torque;
};

/// The joint's motions, smoothed alike. Throws DataError as motion_along does.
[[nodiscard]] std::vector<Motion> arm_motions(const ArmLog& log, Seconds smoothing);

/// Friction as nuisance parameters of an arm fit, without which the arm's values would be biased; not
/// reported as findings. The terms of each joint, in newton-metres for its unit: constant; side of the motion
/// s = tanh(v / 1.5 deg/s); v in rad/s; s exp(-(v / 8.6 deg/s)^2); |s|; |v|.
enum class BesideArm { offset, coulomb, viscous, stribeck, coulomb_by_side, viscous_by_side };
inline constexpr std::size_t values_beside_arm = 6;  ///< number of values in BesideArm

struct ArmFitOptions {
    std::vector<bool> use;             ///< rows that count, one entry each; empty: all
    std::vector<std::size_t> joints;   ///< joints whose torque counts; empty: all that have one
    std::optional<Seconds> smoothing;  ///< left out: the best of arm_smoothings for rows left out
    std::optional<double> pull;        ///< left out: the best of 1e-6 ... 1e4, the same way
};
inline constexpr std::array arm_smoothings = {Seconds(0.05), Seconds(0.08), Seconds(0.12), Seconds(0.2),
                                              Seconds(0.3)};

/// What the fit found of one joint.
struct ArmJointFit {
    std::size_t joint = 0;  ///< index of the joint in the chain
    double rotor_inertia_kgm2 = 0.0;
    std::array<double, values_beside_arm> beside_nm{};  ///< as BesideArm
    /// rms residual of the smoothed torque, and of the torque as logged, on held-out fifths of the rows.
    double smoothed_error_nm = 0.0, error_nm = 0.0;
    /// The estimate of the links from all other joints' torques and the pull, without this joint: mean, and
    /// the inverse of the covariance row after row. Its unit of weight: a row every `weighed_rows` is a
    /// measurement with deviation smoothed_error_nm.
    std::vector<double> mean, precision;
};

struct ArmFit {
    std::vector<double> values;       ///< ten a link; not unique: the least that give the torque
    std::vector<double> deviation;    ///< prior deviation of each value from 0
    double pull = 0.0;                ///< towards 0, in units of (5 kg, 0.5 kg m, 0.1 kg m^2) of a 100 Nm arm
    Seconds smoothing;                ///< smoothing of the motion that the arm terms use
    double weighed_rows = 1.0;        ///< rows of the log to one row of the fit
    std::vector<ArmJointFit> joints;  ///< joints whose torque counted
    std::size_t values_there = 0, values_told = 0;

    [[nodiscard]] const ArmJointFit* find(std::size_t joint) const;
};

/// Throws UsageError where no joint has a torque or sizes do not agree, DataError where no joint moves, a row
/// is not finite, or fewer than 100 rows count.
[[nodiscard]] ArmFit fit_arm(const Chain& chain, const ArmLog& log, const ArmFitOptions& options = {});

/// The fitted torque of one joint, along this log or another one: arm and rotor, smoothed over the same
/// window, and the nuisance terms.
[[nodiscard]] std::vector<double> fitted_torque(const Chain& chain, const ArmFit& fit, const ArmLog& log,
                                                std::size_t joint);

// A fitted arm as part of a model: known columns, fitted together with every candidate of a search.

/// The prior on the arm before the torque of the current joint is used.
enum class ArmKnowledge {
    /// Nothing but the pull: a value a column, its mean 0, its deviation ArmFit::deviation.
    pull,
    /// Also the information of the other joints' torques. Values that they determine together are no longer
    /// values of one link: a column a combination, with a mean and a deviation of 1 in it.
    other_joints,
};

/// Columns for the rows of `log`, those of links before the joint left out, and the rotor's last where it can
/// be distinguished from them; all smoothed over ArmFit::smoothing. Deviations are for a fit in which each
/// row of the log is a measurement with deviation `row_noise_nm`: the prior has there the weight that it has
/// in the fit of the arm. `row_noise_nm` left out: the residual of this joint's torque in the arm fit, spread
/// over the rows that the fit combined into one. `motions`: arm_motions of the log over ArmFit::smoothing,
/// where they are known already.
[[nodiscard]] GivenTerm arm_term(const Chain& chain, const ArmFit& fit, const ArmLog& log, std::size_t joint,
                                 ArmKnowledge knowledge = ArmKnowledge::other_joints,
                                 std::optional<double> row_noise_nm = {},
                                 std::span<const Motion> motions = {});

// An arm as a part of a model: its chain, and the values of its links once they are known. It predicts the
// torque of one joint along any log of all joints, and needs neither the robot's description nor the log that
// it was fitted to.

struct ArmValues {
    std::vector<double> links;        ///< values_of_a_link each, in the order of arm_columns; not unique
    double rotor_inertia_kgm2 = 0.0;  ///< inertia of the joint's own rotor, reflected to the joint

    bool operator==(const ArmValues&) const = default;
};

struct StatedArm {
    Chain chain;
    std::string joint;                     ///< joint of the chain that the torque belongs to
    std::vector<std::string> log_joints;   ///< names in a log, in the order of the chain
    std::optional<ArmValues> values = {};  ///< left out: fitted
    /// Smoothing of the motion that the arm terms use; left out: chosen by a fit.
    std::optional<Seconds> smoothing = {};

    /// Which joint of the chain is which of a log.
    [[nodiscard]] StatedJoints stated_joints() const;
};

/// The links that values of arm_term's columns mean, `of_term` in their order. Combinations of values that
/// are not identifiable from the joint's torque are those of the fit of all joints.
[[nodiscard]] ArmValues arm_values(const Chain& chain, const ArmFit& fit, std::size_t joint,
                                   std::span<const double> of_term,
                                   ArmKnowledge knowledge = ArmKnowledge::other_joints);

/// The torque in newton-metres of one joint along a log: links and rotor, smoothed as arm_term's columns are,
/// so that it is the same torque. Throws what arm_motions throws.
[[nodiscard]] std::vector<double> stated_torque(const Chain& chain, const ArmValues& values,
                                                Seconds smoothing, const ArmLog& log, std::size_t joint);

// The torque of an arm's rigid bodies: linear in ten values a link.

/// The values of each link, in this order: mass (kg); mass times position of its centre x, y, z (kg m);
/// inertia about the origin of the link's frame xx, xy, xz, yy, yz, zz (kg m^2). All in the link's frame.
inline constexpr std::size_t values_of_a_link = 10;

/// The torque of one joint that one unit of each value brings: 10 columns a link of the chain, from the base
/// on, each with an entry per sample. `motions` are those of the joints in the order of the chain, of equal
/// length; of a prismatic joint the fields that are named for degrees hold metres, and its torque is a force
/// in newtons. Columns of links before `joint` are 0. The recursion is that of Newton and Euler, written for
/// unknown masses (Khosla 1986; Siciliano et al., Robotics, 2009, section 7.5).
[[nodiscard]] std::vector<std::vector<double>> arm_columns(const Chain& chain,
                                                           std::span<const Motion> motions,
                                                           std::size_t joint);

/// The torque in newton-metres of one joint of an arm whose values are known: 10 a link.
[[nodiscard]] std::vector<double> arm_torque(const Chain& chain, std::span<const double> values,
                                             std::span<const Motion> motions, std::size_t joint);

/// How many combinations of its values are identifiable by any motion: from the torques of all joints
/// together, and from those of one joint alone.
[[nodiscard]] std::size_t arm_values_there(const Chain& chain);
[[nodiscard]] std::size_t arm_values_there(const Chain& chain, std::size_t joint);

/// Whether an inertia that turns with the motor of this joint alone can be distinguished from the links'.
[[nodiscard]] bool rotor_is_identifiable(const Chain& chain, std::size_t joint);

}  // namespace ripplenotch
