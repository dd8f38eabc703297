// SPDX-License-Identifier: MIT
#pragma once
// Everything that reading a log gives, as bytes that can be compared.

#include <string>
#include <string_view>

#include "ripplenotch/log/log.hpp"

namespace ripplenotch::fuzz {

/// Rows, places of the torque cells and the message at the end, of a log in pieces of at most `piece` bytes.
/// What stands outside +-1e30, or is no number, ends the run: nobody asked for columns that are missing.
[[nodiscard]] std::string reading(std::string_view bytes, const ReadOptions& options, std::size_t piece);

/// Options by their number; most are none at all.
[[nodiscard]] ReadOptions options_of(unsigned choice);

}  // namespace ripplenotch::fuzz
