// SPDX-License-Identifier: MIT
#pragma once
// Internal to the log room: which format the first bytes of a file are.

#include <span>
#include <string>
#include <string_view>

#include "ripplenotch/log/format.hpp"

namespace ripplenotch {

/// What detect_format() looks at.
inline constexpr std::size_t first_bytes_size = 512;

/// The one of `formats` that knows these bytes, else CSV, whose own messages say what is wrong with them.
/// Throws DataError, naming `source`, for files of other kinds that people hand over by mistake.
[[nodiscard]] const LogFormat& detect_format(std::string_view first_bytes, const std::string& source,
                                             std::span<const LogFormat* const> formats = log_formats());

}  // namespace ripplenotch
