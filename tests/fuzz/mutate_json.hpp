// SPDX-License-Identifier: MIT
#pragma once
#include <string>
#include <string_view>

namespace ripplenotch::fuzz {

/// The document with one to three changes of its structure: a value of another type or size, something taken
/// out, repeated, moved or nested. Empty for what is no JSON. The same for the same seed.
[[nodiscard]] std::string mutated_json(std::string_view text, unsigned seed);

}  // namespace ripplenotch::fuzz
