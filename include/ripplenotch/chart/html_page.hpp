// SPDX-License-Identifier: MIT
#pragma once
// A page as one self-contained HTML file that asks no network for anything.

#include <functional>
#include <optional>
#include <string>

#include "ripplenotch/figure/page.hpp"

namespace ripplenotch {

struct HtmlParts {
    std::optional<std::string> plotly_js;  ///< the library's text; without it pictures take its place
    std::function<std::string(const Figure&)> plotly_figure;  ///< {"data": ..., "layout": ...}, no "<" in it
    std::function<std::optional<std::string>(const Figure&)> svg;  ///< empty: no picture either
};

/// The same page gives the same bytes. Only the two scripts that it holds itself may run: its content
/// security policy names them by their hashes and forbids every address.
[[nodiscard]] std::string html_page(const Page& page, const HtmlParts& parts);

/// Text between tags and in attributes.
[[nodiscard]] std::string html_escaped(std::string_view text);

}  // namespace ripplenotch
