// SPDX-License-Identifier: MIT
#pragma once
#include <string_view>

namespace ripplenotch {

// Style and drawing of a page: its style sheet, and the script that passes its figures to plotly.js.

/// Light or dark by the reader's system setting; print is light.
extern const std::string_view page_style;

/// Draws every block of figure data, in the colours of the page and within its width, and again when the
/// reader changes from light to dark.
extern const std::string_view page_script;

}  // namespace ripplenotch
