// SPDX-License-Identifier: MIT
#pragma once
// The angle of a log that has no position: the integral of a noisy speed walks away, and the ripple, which is
// locked to the motor, tells how far.

#include "diagnose/case/case.hpp"
#include "ripplenotch/model/model.hpp"

namespace ripplenotch {

/// Where a walk is to be told.
enum class WalkOf {
    log,        ///< of the log that the model was fitted to: where it begins is in the phases of the model
    other_log,  ///< of another one, which the model is held against with all its values
};

/// The steps in which a walk is told, each from where the one before has led.
inline constexpr int walk_steps = 3;

/// One step: moves the position of a case by what the torque says of its walk, beside the values that `open`
/// leaves out and `stated` has: by the sines of motion_errors(), drawn to their usual sizes, and for another
/// log by a constant. A case without a walk is moved by the constant alone, the log itself not at all.
void step_of_walk(Case& looked_at, const Model& open, const Model& stated, WalkOf of,
                  const RecordingRules& rules);

/// All steps, with the same model.
void take_out_walk(Case& looked_at, const Model& open, const Model& stated, WalkOf of,
                   const RecordingRules& rules);

/// Puts another log of the same joint, which began at an angle that nobody knows, where the model predicts
/// its torque best: within a turn of the motor by the ripple, and at one of its turns by what goes with the
/// output's angle, where the model has that. Then its walk is taken out.
void put_in_place(Case& other, const Model& stated, const RecordingRules& rules);

/// Whether the joint turns so far in both directions that what goes with the output's angle can be told from
/// what goes with direction, speed or time, though nobody knows where it began.
[[nodiscard]] bool tells_position(const Motion& motion, const RecordingRules& rules);

}  // namespace ripplenotch
