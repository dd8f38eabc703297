// SPDX-License-Identifier: MIT
#pragma once
// Names from files and command lines, made fit to be shown, and lists of them.

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "ripplenotch/core/number.hpp"

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

/// What `text_of` makes of each, and `between` between them; empty texts are left out.
template <class Range, class TextOf>
[[nodiscard]] std::string joined(const Range& all, std::string_view between, const TextOf& text_of) {
    std::string text;
    for (const auto& one : all) {
        const std::string part(std::invoke(text_of, one));
        if (!text.empty() && !part.empty()) text += between;
        text += part;
    }
    return text;
}

/// Texts as they are, numbers and quantities as shortest() writes them: "1,2".
template <class Range>
[[nodiscard]] std::string joined(const Range& all, std::string_view between) {
    return joined(all, between, [](const auto& one) -> std::string {
        if constexpr (requires { one.value(); })
            return shortest(one.value());
        else if constexpr (requires { shortest(one); })
            return shortest(one);
        else
            return std::string(one);
    });
}

}  // namespace ripplenotch
