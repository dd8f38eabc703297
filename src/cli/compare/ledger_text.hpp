// SPDX-License-Identifier: MIT
#pragma once
// A delay ledger as people read it.

#include <string>

#include "ripplenotch/evaluate/comparison.hpp"

namespace ripplenotch {

/// One table a method, a row for every band or speed, and for each method that has a limit the speed from
/// which it keeps it. Empty when no ledger was asked for.
[[nodiscard]] std::string ledger_text(const Comparison& comparison);

}  // namespace ripplenotch
