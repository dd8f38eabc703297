// SPDX-License-Identifier: MIT
#pragma once
// What a diagnosis does about the angle of a log without position.

#include "diagnose/case/case.hpp"
#include "diagnose/search/model_bench.hpp"
#include "ripplenotch/diagnose/diagnosis.hpp"
#include "ripplenotch/model/model.hpp"

namespace ripplenotch {

// The angle of a log that has no position: the integral of a noisy speed walks away, and the ripple, which is
// locked to the motor, tells how far.

/// Where a walk is to be told.
enum class WalkOf {
    log,        ///< of the log that the model was fitted to: where it begins is in the phases of the model
    other_log,  ///< of another one, which the model is held against with all its values
};

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

/// Takes the walk out that the model as given tells, its open values fitted.
void straighten(Case& whole, const Model& model, const DiagnosisRules& rules);

/// The same by what was found, of the same log. True when that changes the predicted torque by more than does
/// not matter beside `floor_nm`: what was found before should be looked at again.
[[nodiscard]] bool straightened_by(Case& whole, const Candidate& found, double floor_nm,
                                   const DiagnosisRules& rules);

/// The angles as they were measured or integrated, to say what became of them.
class AngleBefore {
  public:
    AngleBefore(const Case& log, bool has_position);
    void of_other(const Case& other) { other_ = other.motion.position_deg; }
    [[nodiscard]] bool has_other() const { return !other_.empty(); }
    /// Empty where nothing was to be told.
    [[nodiscard]] std::optional<AngleAccount> account(const Case& log, const Case* other) const;

  private:
    std::vector<double> log_, other_;
};

}  // namespace ripplenotch
