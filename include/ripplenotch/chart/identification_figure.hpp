// SPDX-License-Identifier: MIT
#pragma once
#include "ripplenotch/analysis/identification.hpp"
#include "ripplenotch/figure/figure.hpp"

namespace ripplenotch {

/// Line frequency against speed with the fitted ratio, what the fit leaves, and amplitude against speed.
[[nodiscard]] Figure identification_figure(const std::string& source, const Identification& identification);

}  // namespace ripplenotch
