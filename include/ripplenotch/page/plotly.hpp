// SPDX-License-Identifier: MIT
#pragma once
#include <string>

#include "ripplenotch/figure/figure.hpp"

namespace ripplenotch {

/// A figure for plotly.js 3: {"data": [...], "layout": {...}}, panels one under the other, equal time axes
/// linked; "narrow", where it is there, lists what is otherwise on a phone: {"path", "value"}. Names are
/// escaped for plotly's own markup; the text holds no "<", so that it can stand in a page.
[[nodiscard]] std::string plotly_text(const Figure& figure);

}  // namespace ripplenotch
