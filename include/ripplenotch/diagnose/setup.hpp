// SPDX-License-Identifier: MIT
#pragma once
// Hypotheses on how a simulation and a log were put together, tested before any effect of the joint.

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "ripplenotch/core/trace.hpp"
#include "ripplenotch/model/fit.hpp"
#include "ripplenotch/model/setup_fault.hpp"

namespace ripplenotch {

/// A simulation on its own clock. A series that it does not have is empty.
struct SimulatedMotion {
    std::vector<double> time_s, position_deg, velocity_deg_s;
    std::vector<double> torque_nm;
};

/// A shorter delay is within the definition of the sampling instant.
inline constexpr double least_delay_samples = 0.75;

/// A delay, d, in log(t) = scale * simulation(t - d): above 0 the log is behind, the simulation early.
struct SimulationLag {
    bool is_compared = false;   ///< log and simulation are long enough, and both change
    bool identifiable = false;  ///< one delay fits, and explains enough of blocks that were not fitted
    double delay_s = 0.0;
    Interval delay_95_s;  ///< delete-a-block jackknife, Student's t
    double scale = 1.0;   ///< of the simulation, fitted with the lag
    /// Relative difference of the two clocks: the delay grows by so many seconds a second, and is delay_s in
    /// the middle of the log. Empty where it cannot be distinguished from 0 at the level of 0.1 %.
    std::optional<double> clock_error;
    double correlation = 0.0;  ///< at the lag, of what was fitted
    /// Share of the variance, of what nuisance parameters alone leave, that the simulation at this lag
    /// explains of blocks that it was not fitted to.
    double explained = 0.0;
    double left = 0.0;                              ///< sum of squares of these blocks
    std::optional<double> position_difference_deg;  ///< rms, where both have a position
};

/// From the motions: the velocities over a triangular window (of positions their slope, so that a slow
/// difference of the positions has little weight), on a grid of delays, then by Gauss-Newton steps. The times
/// of both are taken as they are.
[[nodiscard]] SimulationLag lag_by_motion(const TraceView& log, const SimulatedMotion& simulation);

/// From the torques over the same window, together with nuisance parameters: an offset, friction (Coulomb of
/// two widths, viscous) and, with a gear ratio, ripple of motor orders 1 and 2 whose amplitude is an affine
/// function of the speed. Inertia, gravity, friction that grows with the torque and hysteresis join them
/// where they halve the squares of held-out blocks at about the same scale.
[[nodiscard]] SimulationLag lag_by_torque(const TraceView& log, const SimulatedMotion& simulation,
                                          std::optional<GearRatio> gear_ratio = {});

/// Another joint of the same log.
struct LoggedJoint {
    std::string name;
    TraceView trace;
};

/// Of a command behind whose delay a drive's torque is: simulation.torque_nm is the command's part of it, and
/// log.torque_nm that of position and velocity, with the opposite sign. The delay at which inertia, friction
/// and weight of the joint leave least between the two.
[[nodiscard]] SimulationLag lag_by_law(const TraceView& log, const SimulatedMotion& command);

struct SetupContext {
    std::optional<GearRatio> gear_ratio = {};
    /// Names of the simulation's columns, as options have them; empty: it has no such column.
    std::string torque_column = "simulated", position_column = "position", velocity_column = "velocity";
    double torque_scale = 1.0;  ///< stated, and in the simulation's torque already
    std::string joint;          ///< name of the log's joint; may be empty
    std::vector<LoggedJoint> others = {};
};

struct SetupAnswer {
    std::vector<SetupFault> faults;  ///< faults that invalidate the others first
    /// By the motions, by the torques, and of the simulated torque behind the motion of the log that explains
    /// it. Empty where simulation or log lack the required columns.
    std::optional<SimulationLag> motion_lag, torque_lag, torque_to_motion_lag;
    std::optional<SimulationLag> shift;  ///< by which the simulation is taken to be early

    /// The one that can be relied on: by the motions, or else where the motion of the log explains the
    /// simulated torque, which the torques may tell more precisely, or else by the torques; null: none.
    [[nodiscard]] const SimulationLag* lag() const;
};

/// Tests of the motions: another joint, another motion, sign, rad for deg, motor side; of the torques at the
/// lag that was found: another joint, another motion, sign, mNm for Nm, motor side, direction of gravity. A
/// scale between these factors is no fault of the set-up. Torques are compared over the window of the lag
/// together with an offset and friction of any size. Of 150 simulated logs with random effects, payloads,
/// lags and tracking errors that the simulation lacks none has a fault (the study in
/// tests/diagnose/setup_test.cpp): below 2 % at 95 % confidence.
[[nodiscard]] SetupAnswer suspect_setup(const TraceView& log, const SimulatedMotion& simulation,
                                        const SetupContext& context);

}  // namespace ripplenotch
