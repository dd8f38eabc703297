// SPDX-License-Identifier: MIT
#pragma once
// The values of an arm's links from a log of its joints: all joints at once, with friction beside them, drawn
// towards 0 by as much as serves a motion that the fit has not seen.

#include <array>
#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

#include "ripplenotch/arm/arm_dynamics.hpp"
#include "ripplenotch/core/trace.hpp"

namespace ripplenotch {

/// The joints of a chain in a log, in the order of the chain: rows of the same times, each with a position.
/// The torque of a joint without one may hold anything.
struct ArmLog {
    std::vector<TraceView> joints;
    std::vector<bool> has_torque;
};

/// The joint's motions, smoothed alike. Throws DataError as motion_along does.
[[nodiscard]] std::vector<Motion> arm_motions(const ArmLog& log, Seconds smoothing);

/// Friction that an arm needs beside it, or it bends to it; nobody named it. Of each joint, in newton-metres
/// for its unit: constant; side of the motion s = tanh(v / 1.5 deg/s); v in rad/s; s exp(-(v / 8.6
/// deg/s)^2); |s|; |v|.
enum class BesideArm { offset, coulomb, viscous, stribeck, coulomb_by_side, viscous_by_side };
inline constexpr std::size_t values_beside_arm = 6;  ///< of BesideArm

struct ArmFitOptions {
    std::vector<bool> use;             ///< rows that count, one entry each; empty: all
    std::vector<std::size_t> joints;   ///< whose torque counts; empty: of all that have one
    std::optional<Seconds> smoothing;  ///< left out: the best of arm_smoothings for rows left out
    std::optional<double> pull;        ///< left out: the best of 1e-6 ... 1e4, the same way
};
inline constexpr std::array arm_smoothings = {Seconds(0.05), Seconds(0.08), Seconds(0.12), Seconds(0.2),
                                              Seconds(0.3)};

/// What the fit found of one joint.
struct ArmJointFit {
    std::size_t joint = 0;  ///< of the chain
    double rotor_inertia_kgm2 = 0.0;
    std::array<double, values_beside_arm> beside_nm{};  ///< as BesideArm
    /// rms of what is left of the smoothed torque, and of the torque as logged, on fifths of the rows that
    /// the fit was made without.
    double smoothed_error_nm = 0.0, error_nm = 0.0;
    /// What all other joints' torques and the pull say of the links, without this joint: mean, and the
    /// inverse of the covariance row after row. Its unit of weight: a row every `weighed_rows` is a
    /// measurement with deviation smoothed_error_nm.
    std::vector<double> mean, precision;
};

struct ArmFit {
    std::vector<double> values;       ///< ten a link; not unique: the least that give the torque
    std::vector<double> deviation;    ///< of each value before the log: how far it may go from 0
    double pull = 0.0;                ///< towards 0, in units of (5 kg, 0.5 kg m, 0.1 kg m^2) of a 100 Nm arm
    Seconds smoothing;                ///< of the motion that the arm sees
    double weighed_rows = 1.0;        ///< rows of the log to one row of the fit
    std::vector<ArmJointFit> joints;  ///< whose torque counted
    std::size_t values_there = 0, values_told = 0;

    [[nodiscard]] const ArmJointFit* find(std::size_t joint) const;
};

/// Throws UsageError where no joint has a torque or sizes do not agree, DataError where no joint moves, a row
/// is not finite, or fewer than 100 rows count.
[[nodiscard]] ArmFit fit_arm(const Chain& chain, const ArmLog& log, const ArmFitOptions& options = {});

/// The torque of one joint that was fitted, along this log or another one: arm and rotor,
/// smoothed over the same window, and what is beside it.
[[nodiscard]] std::vector<double> fitted_torque(const Chain& chain, const ArmFit& fit, const ArmLog& log,
                                                std::size_t joint);

}  // namespace ripplenotch
