// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <string_view>

namespace ripplenotch {

/// ASCII letters in lower case, all other bytes as they are: names of files and columns are compared alike in
/// every locale.
[[nodiscard]] inline std::string lower_case(std::string_view text) {
    std::string lower(text);
    for (char& c : lower)
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    return lower;
}

}  // namespace ripplenotch
