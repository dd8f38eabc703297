// SPDX-License-Identifier: MIT
#pragma once

#include <span>

namespace ripplenotch {

/// Root mean square; 0 of no values.
[[nodiscard]] double rms(std::span<const double> values);

}  // namespace ripplenotch
