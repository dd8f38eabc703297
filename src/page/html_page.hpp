// SPDX-License-Identifier: MIT
#pragma once
#include <string_view>

namespace ripplenotch {

// How a page looks and draws: its style sheet, and the script that gives its figures to plotly.js.

/// Light and dark by what the reader's system prefers; print is light.
extern const std::string_view page_style;

/// Draws every block of figure data, in the colours of the page and within its width, and again when the
/// reader changes from light to dark.
extern const std::string_view page_script;

}  // namespace ripplenotch
