// SPDX-License-Identifier: MIT
#pragma once
#include <string_view>

namespace ripplenotch {

inline constexpr std::string_view tool_name = "ripplenotch";
[[nodiscard]] std::string_view version();

}  // namespace ripplenotch
