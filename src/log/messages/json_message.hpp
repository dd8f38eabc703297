// SPDX-License-Identifier: MIT
#pragma once
#include <string_view>

#include "log/messages/message_columns.hpp"

namespace ripplenotch {

/// lay_out_message() of messages in JSON, an object each. Whether a schema says more about them makes no
/// difference: numbers say that they are. They are 64-bit floats, but for whole ones beyond 2^53.
[[nodiscard]] MessageLayout lay_out_json(std::string_view first);

/// A log in JSON: an object a line, a list of objects, or an object of lists of numbers; the longest that
/// there is. Throws DataError, beginning with `source`.
[[nodiscard]] ColumnLog columns_of_json(const std::string& source, std::string_view text);

}  // namespace ripplenotch
