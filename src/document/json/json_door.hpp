// SPDX-License-Identifier: MIT
#pragma once
// The one door through which JSON comes in: nothing behind it meets a document that is deep, huge or
// ambiguous.

#include <string>
#include <string_view>

#include "document/json/json.hpp"

namespace ripplenotch {

/// The document in `text`, within document/json/limits.hpp and with every name once in its object. Throws
/// DataError with source, line and column, what was read, and that `wanted` was expected. Linear in the
/// length of the text.
[[nodiscard]] Json read_json(std::string_view text, const std::string& source, std::string_view wanted);

}  // namespace ripplenotch
