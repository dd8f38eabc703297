// SPDX-License-Identifier: MIT
#pragma once
// What the torque of a log was made of that has a command in its place.

#include <cstddef>
#include <optional>

#include "ripplenotch/core/interval.hpp"

namespace ripplenotch {

struct DrivenTorque {
    double delay_s = 0.0;                ///< of the command
    std::optional<Interval> delay_95_s;  ///< where it was fitted
    double rms_nm = 0.0;
    std::size_t limited = 0;  ///< rows at the limit of the torque
};

}  // namespace ripplenotch
