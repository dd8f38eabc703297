// SPDX-License-Identifier: MIT
#pragma once
#include "ripplenotch/export/target.hpp"

namespace ripplenotch::targets {
#define TARGET(name) extern const Target name;
#include "export/targets/targets.def"
#undef TARGET
}  // namespace ripplenotch::targets
