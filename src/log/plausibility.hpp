// SPDX-License-Identifier: MIT
#pragma once
// Doubts about a reading that only the values can raise, as warnings: they never change what was read.

#include <string>
#include <vector>

#include "ripplenotch/log/layout.hpp"
#include "ripplenotch/log/timebase.hpp"

namespace ripplenotch {

[[nodiscard]] std::vector<std::string> plausibility_warnings(const Layout& layout, const TraceView& trace,
                                                             const Timebase& timebase);

}  // namespace ripplenotch
