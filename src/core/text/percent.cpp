// SPDX-License-Identifier: MIT
#include "ripplenotch/core/percent.hpp"

#include <fmt/format.h>

#include <cmath>

namespace ripplenotch {

std::string percent_text(double percent) {
    constexpr double least_whole = 9.95,
                     least_shown = 1e-4;  // below, a format of its own would have exponents
    if (std::abs(percent) >= least_whole) return fmt::format("{:.0f}", percent);
    if (std::abs(percent) < least_shown) return "0";
    return fmt::format("{:.2g}", percent);
}

}  // namespace ripplenotch
