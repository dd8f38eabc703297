// SPDX-License-Identifier: MIT
#pragma once
// The outcome of an identification as text.

#include <string>

#include "ripplenotch/analysis/identification.hpp"

namespace ripplenotch {

/// The verdict as text, reasons against it first.
[[nodiscard]] std::string verdict_sentence(const Identification& found);

/// What was found of the motors of other joints, a sentence; empty where nothing was.
[[nodiscard]] std::string other_motors_sentence(const Identification& found);

}  // namespace ripplenotch
