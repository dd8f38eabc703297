// SPDX-License-Identifier: MIT
#pragma once
#include "ripplenotch/diagnose/diagnosis.hpp"
#include "ripplenotch/page/page.hpp"

namespace ripplenotch {

/// The rounds of a diagnosis as a table that fits a page, which is not as wide as the JSON is deep: a round's
/// gap as "0.435 to 0.0497" in one cell, and of its evidence what people ask for first.
[[nodiscard]] PageTable rounds_table(const Diagnosis& diagnosis);

}  // namespace ripplenotch
