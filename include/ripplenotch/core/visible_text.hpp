// SPDX-License-Identifier: MIT
#pragma once
// Names from files and command lines, made fit to be shown.

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace ripplenotch {

/// The text with everything that would act instead of showing written out: control characters and what turns
/// the direction of writing as \n, \x1b, \u202e, bytes that are not UTF-8 as \xff. Anything else stays.
[[nodiscard]] std::string visible_text(std::string_view text);

/// JSON of the same value whose texts hold nothing that acts: these characters as \u001b. `json` is UTF-8.
[[nodiscard]] std::string visible_json(std::string_view json);

/// Characters, as far as a column each is what they take: code points.
[[nodiscard]] std::size_t text_width(std::string_view visible);

/// Cut to `width` characters, the last of them "…" when something was cut off.
[[nodiscard]] std::string cut_to(std::string_view visible, std::size_t width);

/// Lines of at most `width` characters, broken at blanks where there are any.
[[nodiscard]] std::vector<std::string> wrapped(std::string_view visible, std::size_t width);

}  // namespace ripplenotch
