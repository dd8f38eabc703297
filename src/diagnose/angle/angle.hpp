// SPDX-License-Identifier: MIT
#pragma once
// Treatment of the angle of a log without position in a diagnosis.

#include "diagnose/case/case.hpp"
#include "diagnose/search/model_bench.hpp"
#include "ripplenotch/diagnose/diagnosis.hpp"
#include "ripplenotch/model/model.hpp"

namespace ripplenotch {

// The angle of a log that has no position: the integral of a noisy speed has a random-walk error, which is
// estimated from the ripple, since that is locked to the motor.

/// The log whose random-walk error is estimated.
enum class WalkOf {
    log,        ///< the log that the model was fitted to: its initial angle is in the phases of the model
    other_log,  ///< another one, which the model with all its values is compared with
};

/// All steps, with the same model.
void take_out_walk(Case& looked_at, const Model& open, const Model& stated, WalkOf of);

/// Puts another log of the same joint, which began at an unknown angle, where the model predicts its torque
/// best: within a turn of the motor by the ripple, and at one of its turns by the torques that depend on the
/// output's angle, where the model has those. Then its random-walk error is removed.
void put_in_place(Case& other, const Model& stated);

/// Whether the joint turns so far in both directions that torques that depend on the output's angle can be
/// distinguished from those that depend on direction, speed or time, although the initial angle is unknown.
[[nodiscard]] bool tells_position(const Motion& motion);

/// Removes the random-walk error estimated with the model as given, its open values fitted.
void straighten(Case& whole, const Model& model);

/// The same with the result of a search on the same log. True when that changes the predicted torque by more
/// than is negligible relative to `floor_nm`: the search should be repeated then.
[[nodiscard]] bool straightened_by(Case& whole, const Candidate& found, double floor_nm);

/// The angles as they were measured or integrated, for a report of their correction.
class AngleBefore {
  public:
    AngleBefore(const Case& log, bool has_position);
    void of_other(const Case& other) { other_ = other.motion.position_deg; }
    [[nodiscard]] bool has_other() const { return !other_.empty(); }
    /// Empty where nothing had to be estimated.
    [[nodiscard]] std::optional<AngleAccount> account(const Case& log, const Case* other) const;

  private:
    std::vector<double> log_, other_;
};

}  // namespace ripplenotch
