// SPDX-License-Identifier: MIT
#pragma once
// Internal: whether lines of features belong together.

#include <span>
#include <string>
#include <vector>

#include "fleet/trend/joint_history.hpp"

namespace ripplenotch {

/// The lines that can stand in a history: read, with a date, each log and joint once. Throws DataError where
/// none are left, and for lines that do not belong together.
[[nodiscard]] std::vector<const FeatureLine*> dated_lines(std::span<const FeatureLine> lines,
                                                          std::vector<std::string>& notes);

/// A joint that ends where another one of the same robot begins may have a new name.
void note_new_names(const std::vector<JointHistory>& histories, std::vector<std::string>& notes);

}  // namespace ripplenotch
