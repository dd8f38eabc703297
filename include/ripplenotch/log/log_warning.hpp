// SPDX-License-Identifier: MIT
#pragma once
// What a person should know about a log before believing it.

#include <string>
#include <string_view>

namespace ripplenotch {

struct LogWarning {
    std::string_view about;     ///< what it is about, alike for all joints that are warned of the same
    std::string text;           ///< one sentence
    bool of_one_joint = false;  ///< it holds a column or a figure of the joint that was read
    bool operator==(const LogWarning&) const = default;
};

}  // namespace ripplenotch
