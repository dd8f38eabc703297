// SPDX-License-Identifier: MIT
#pragma once
// What a diagnosis does about the angle of a log without position.

#include "diagnose/angle/walk.hpp"
#include "diagnose/search/model_bench.hpp"
#include "ripplenotch/diagnose/diagnosis.hpp"

namespace ripplenotch {

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
