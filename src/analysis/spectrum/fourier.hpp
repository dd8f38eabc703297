// SPDX-License-Identifier: MIT
#pragma once

namespace ripplenotch {

/// Noise bandwidth of a Hann window, in bins of one over its length.
inline constexpr double hann_cell = 1.5;

}  // namespace ripplenotch
