// SPDX-License-Identifier: MIT
#include "core/rows/rms.hpp"

#include <algorithm>
#include <cmath>

#include "core/vectors/dot.hpp"

namespace ripplenotch {

double rms(std::span<const double> values) {
    const double sum = dot(values.data(), values.data(), values.size());
    return std::sqrt(sum / static_cast<double>(std::max<std::size_t>(values.size(), 1)));
}

}  // namespace ripplenotch
