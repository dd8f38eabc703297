// SPDX-License-Identifier: MIT
#pragma once
// Rows of the opening of a text log, for what they say about units.

#include <string_view>

#include "log/columns/decide_layout.hpp"
#include "log/text/text_dialect.hpp"

namespace ripplenotch {

/// All whole lines of `bytes`, which begin with the first row. Rows that are no numbers are left out. Without
/// a time column, time counts the rows.
[[nodiscard]] MotionSample text_motion_sample(std::string_view bytes, const TextDialect& dialect,
                                              const MotionPlaces& places);

}  // namespace ripplenotch
