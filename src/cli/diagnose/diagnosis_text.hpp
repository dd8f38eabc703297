// SPDX-License-Identifier: MIT
#pragma once
// A diagnosis as a story for people.

#include <string>
#include <vector>

#include "cli/options/options.hpp"
#include "ripplenotch/arm/arm_setup.hpp"
#include "ripplenotch/diagnose/diagnosis.hpp"

namespace ripplenotch {

// The end of the story: what was accepted, where the gap is, what to do next; and numbers as a story has
// them.

/// Four digits.
[[nodiscard]] std::string short_number(double value);

/// "torque_nm = 0.8 [0.7, 0.9]"
[[nodiscard]] std::string value_text(const Term& term, const FittedValue& value);

/// `explain`: all findings in full, and why each refused candidate was not named.
[[nodiscard]] std::string diagnosis_story(const CommonOptions& common, const Diagnosis& diagnosis,
                                          bool explain = false);

/// "arm: 6 joints of ur10.urdf matched by number (-v shows them); 36 of 36 combinations ... 0.1 s", and what
/// it leaves.
[[nodiscard]] std::string arm_text(const ArmAccount& account);

}  // namespace ripplenotch
