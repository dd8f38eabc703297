// SPDX-License-Identifier: MIT
#pragma once
// A page as one self-contained HTML file that asks no network for anything.

#include <optional>
#include <string>
#include <string_view>

#include "ripplenotch/page/page.hpp"

namespace ripplenotch {

/// `plotly_js` is the text of that library, which draws the figures; without it gnuplot's pictures take their
/// place. The same page gives the same bytes. Only the two scripts that it holds itself may run: its content
/// security policy names them by their hashes and forbids every address.
[[nodiscard]] std::string html_page(const Page& page, const std::optional<std::string>& plotly_js);

/// Text between tags and in attributes.
[[nodiscard]] std::string html_escaped(std::string_view text);

}  // namespace ripplenotch
