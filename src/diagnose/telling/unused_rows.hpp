// SPDX-License-Identifier: MIT
#pragma once
// Rows of the log that do not count, and effects that act mainly there: such an effect is not found, however
// large it is.

#include <span>
#include <string_view>
#include <vector>

#include "diagnose/case/case.hpp"
#include "ripplenotch/diagnose/diagnosis.hpp"

namespace ripplenotch {

/// Adds the rows that the case lacks beside those that are listed, where there are any.
void add_unused_rows(std::vector<UnusedRows>& listed, const Case& whole, std::string_view reason);

/// Of these effects those that have half of their largest torque or more mainly in rows that do not count,
/// each by itself with the sizes at which a search begins.
[[nodiscard]] std::vector<EffectOfUnusedRows> mainly_unused(std::span<const Effect* const> effects,
                                                            const Case& whole, const Model& model);

}  // namespace ripplenotch
