// SPDX-License-Identifier: MIT
#pragma once
// Internal to the log room: reading on until there is enough, or no more.

#include <cstddef>
#include <string>

#include "ripplenotch/core/files.hpp"

namespace ripplenotch {

/// Behind the first `have` of `bytes`, until there are `size` or the source ends; returns how many there are.
/// The room grows with what comes: most logs are short of what is asked for.
[[nodiscard]] std::size_t read_on(ByteSource& source, std::string& bytes, std::size_t have, std::size_t size);

}  // namespace ripplenotch
