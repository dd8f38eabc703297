// SPDX-License-Identifier: MIT
#pragma once
// A diagnosis as a story for people.

#include <string>

#include "ripplenotch/diagnose/diagnosis.hpp"

namespace ripplenotch {

/// `explain`: with the rules that were asked about each finding and each refused candidate.
[[nodiscard]] std::string diagnosis_story(const Diagnosis& diagnosis, bool explain = false);

}  // namespace ripplenotch
