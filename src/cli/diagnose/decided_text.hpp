// SPDX-License-Identifier: MIT
#pragma once
// The end of the story: what was accepted, where the gap is, what to do next; and numbers as a story has
// them.

#include <string>
#include <vector>

#include "ripplenotch/diagnose/diagnosis.hpp"

namespace ripplenotch {

/// Four digits.
[[nodiscard]] std::string short_number(double value);
/// "torque_nm = 0.8 [0.7, 0.9]"
[[nodiscard]] std::string value_text(const Term& term, const FittedValue& value);

/// A line a finding that the user took into the model; nothing without one.
[[nodiscard]] std::string accepted_text(const Diagnosis& diagnosis);
/// Where in frequency the torque is, and what is left of it; nothing without given terms.
[[nodiscard]] std::string band_table(const std::vector<BandGap>& bands);
/// "next: ..." a line a step.
[[nodiscard]] std::string next_text(const std::vector<std::string>& steps);

}  // namespace ripplenotch
