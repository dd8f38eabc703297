// SPDX-License-Identifier: MIT
#pragma once
// A method's keys that a joint.json or the command line can fill.

#include <string>
#include <string_view>

#include "cli/chosen_method.hpp"
#include "ripplenotch/core/spec.hpp"

namespace ripplenotch {

[[nodiscard]] bool has_key(const Method& method, std::string_view key);

/// Adds gear-ratio, orders and joint from the options to a method that has these keys and is not given them.
void fill_from_options(Spec& spec, const Method& method, const GearOptions& gear);

/// Replaces joint=FILE by the keys that the file fills: gear ratio, orders, and amplitudes and phases where
/// the method has keys for them. Keys that are given stay as they are. The path, empty when there was none.
/// Throws DataError when the file has no gear ratio or no order that the method could use.
[[nodiscard]] std::string spell_out_joint(Spec& spec, const Method& method);

}  // namespace ripplenotch
