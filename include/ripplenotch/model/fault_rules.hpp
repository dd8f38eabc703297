// SPDX-License-Identifier: MIT
#pragma once
// Limits by which an effect of the converter is distinguished from a torque that resembles it.

#include <cstddef>

namespace ripplenotch {

/// Numbers by which Effect::detect decides. Each line of fault_rules.def is one: its value, the bounds within
/// which it may be changed, its unit, and its reason.
struct FaultRules {
#define NUMBER(name, value, lowest, highest, unit, why) double name = value;
#define WHOLE(name, value, lowest, highest, unit, why) std::size_t name = value;
#include "ripplenotch/model/fault_rules.def"
#undef NUMBER
#undef WHOLE
};

}  // namespace ripplenotch
