// SPDX-License-Identifier: MIT
#pragma once
// The fixed parts of the C header, with @fields@ to fill in. Its arithmetic is that of
// export/run/structure.hpp, operation by operation.

#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "ripplenotch/export/arithmetic.hpp"

namespace ripplenotch::c_code {

/// Declarations by which a reader knows the form of a header.
inline constexpr std::string_view svf_fields = "a1, a2, a3, m0, m1, m2;";
inline constexpr std::string_view df1_memory = "x1, x2, y1, y2;";

[[nodiscard]] std::string declarations(Form form);
[[nodiscard]] std::string regions_open();
[[nodiscard]] std::string section_functions(Form form);
[[nodiscard]] std::string step_function(bool by_speed);
[[nodiscard]] std::string self_test_open();
[[nodiscard]] std::string self_test_function(bool by_speed);
[[nodiscard]] std::string filled(std::string text,
                                 std::span<const std::pair<std::string_view, std::string>> fields);

}  // namespace ripplenotch::c_code
