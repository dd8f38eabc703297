// SPDX-License-Identifier: MIT
#pragma once
#include <cstddef>
#include <cstdlib>
#include <string_view>

namespace ripplenotch::test {

/// How many rounds of a check that draws its cases: all of them, or a tenth in the short version that a
/// commit runs of what takes long (RIPPLENOTCH_SHORT=1, set by ctest); scripts/nightly runs all.
[[nodiscard]] inline std::size_t rounds(std::size_t all) {
    const char* const shortened = std::getenv("RIPPLENOTCH_SHORT");
    return shortened != nullptr && std::string_view(shortened) == "1" ? all / 10 : all;
}

}  // namespace ripplenotch::test
