// SPDX-License-Identifier: MIT
#pragma once
// A diagnosis as a story for people.

#include <string>

#include "ripplenotch/diagnose/diagnosis.hpp"

namespace ripplenotch {

[[nodiscard]] std::string diagnosis_story(const Diagnosis& diagnosis);

}  // namespace ripplenotch
