// SPDX-License-Identifier: MIT
#pragma once
#include <string_view>
#include <vector>

#include "ripplenotch/export/target.hpp"

// The entries of the target registry, declared from its one list.

namespace ripplenotch {

/// The names of the targets for which this trait is `value`, in the order of the list.
[[nodiscard]] std::vector<std::string_view> targets_that(bool Target::*trait, bool value = true);

}  // namespace ripplenotch

namespace ripplenotch::targets {
#define TARGET(name) extern const Target name;
#include "export/targets/targets.def"
#undef TARGET
}  // namespace ripplenotch::targets
