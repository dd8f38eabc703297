// SPDX-License-Identifier: MIT
#pragma once
// Does the clock agree with the motion? Change of position against integrated velocity, by robust regression.

#include <cstddef>
#include <optional>
#include <span>
#include <string>

#include "ripplenotch/core/trace.hpp"

namespace ripplenotch {

struct ClockCheck {
    std::optional<double>
        factor;  ///< change of position / integrated velocity; empty when there is too little motion
    std::string
        warning;  ///< one sentence when the factor is not 1, or position and velocity do not belong together
};

/// `breaks` are the rows after which a gap follows, ascending. A position that wraps is unwrapped on a copy
/// first.
[[nodiscard]] ClockCheck check_clock(const TraceView& trace, std::span<const std::size_t> breaks,
                                     Hertz sample_rate);

}  // namespace ripplenotch
