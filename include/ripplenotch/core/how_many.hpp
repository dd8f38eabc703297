// SPDX-License-Identifier: MIT
#pragma once
#include <fmt/format.h>

#include <cstddef>
#include <string>
#include <string_view>

namespace ripplenotch {

/// "1 gap", "2 gaps"; `many` where an s does not make the plural: "2 switches".
[[nodiscard]] inline std::string how_many(std::size_t count, std::string_view one,
                                          std::string_view many = {}) {
    if (count == 1) return fmt::format("1 {}", one);
    return many.empty() ? fmt::format("{} {}s", count, one) : fmt::format("{} {}", count, many);
}

}  // namespace ripplenotch
