// SPDX-License-Identifier: MIT
#include "core/rms.hpp"

#include <algorithm>
#include <cmath>

namespace ripplenotch {

double rms(std::span<const double> values) {
    double sum = 0.0;
    for (const double value : values) sum += value * value;
    return std::sqrt(sum / static_cast<double>(std::max<std::size_t>(values.size(), 1)));
}

}  // namespace ripplenotch
