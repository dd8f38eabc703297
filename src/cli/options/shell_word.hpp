// SPDX-License-Identifier: MIT
#pragma once
// Words of command lines that people paste.

#include <string>

namespace ripplenotch {

/// The word as a shell takes it: as it is where it is plain, else in single quotes.
[[nodiscard]] std::string shell_quoted(const std::string& word);

}  // namespace ripplenotch
