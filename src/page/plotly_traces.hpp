// SPDX-License-Identifier: MIT
#pragma once
// The traces of a plotly figure. Each function completes `json`, which holds the axes, the name and the
// legend already.

#include "document/json/json.hpp"
#include "ripplenotch/figure/figure.hpp"

namespace ripplenotch {

/// Text that plotly shows as it is: neither its markup nor a template's %{...}.
[[nodiscard]] std::string plotly_shown(const std::string& text);

[[nodiscard]] Json plotly_number(double value);  ///< eight digits; null for what is not finite

[[nodiscard]] Json curve_trace(Json json, const Panel& panel, const Curve& curve);
/// The lower edge first, then the upper, which fills down to it.
[[nodiscard]] Json ribbon_trace(Json json, const Ribbon& ribbon, bool upper);
/// The colour bar stands beside the panel, between `bottom` and `top` of the figure.
[[nodiscard]] Json map_trace(Json json, const Panel& panel, double bottom, double top);

}  // namespace ripplenotch
