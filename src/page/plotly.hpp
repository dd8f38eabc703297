// SPDX-License-Identifier: MIT
#pragma once
#include <string>

#include "document/json/json.hpp"
#include "figure/gnuplot_picture.hpp"
#include "ripplenotch/figure/figure.hpp"

namespace ripplenotch {

// The traces of a plotly figure. Each function completes `json`, which holds the axes, the name and the
// legend already.

[[nodiscard]] Json curve_trace(Json json, const Panel& panel, const Curve& curve);

}  // namespace ripplenotch
