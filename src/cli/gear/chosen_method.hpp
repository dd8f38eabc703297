// SPDX-License-Identifier: MIT
#pragma once
// A filter method as the user wrote it, checked, with its table loaded and its gear chosen.

#include <functional>
#include <optional>
#include <string>

#include "cli/gear/gear_choice.hpp"
#include "ripplenotch/evaluate/contender.hpp"

namespace ripplenotch {

/// Maps by the names of their files.
using MapSource = std::function<RippleMap(const std::string& path)>;

/// `spec_text` as --method takes it; `table` is a table.json for methods that need one and name none. Keys of
/// the gear that the text leaves out are filled, and joint=FILE is replaced by the keys that it fills, so
/// that the contender's text says all. Throws UsageError on a bad specification, on a gear that is missing,
/// and what load_table, load_joint and refuse_other_gear throw. Maps are read from their files unless `maps`
/// has them.
[[nodiscard]] Contender choose_method(const std::string& spec_text,
                                      const std::optional<std::string>& table = std::nullopt,
                                      const GearChoice& gear = GearChoice({}), const MapSource& maps = {});

/// Throws UsageError, naming both, when the method's map is of a joint of another name than the log's.
void refuse_other_joint(const Contender& method, const std::string& joint);

/// Throws UsageError, naming both, when the method's filter is made for another gear ratio than that whose
/// ripple is measured: by more than 0.5 %, or than a table's own ratio error.
void refuse_other_gear(const Contender& method, const GearAccount& measured);

}  // namespace ripplenotch
