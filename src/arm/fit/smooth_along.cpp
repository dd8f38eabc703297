// SPDX-License-Identifier: MIT
#include "arm/fit/smooth_along.hpp"

#include <algorithm>

namespace ripplenotch {

std::vector<double> smooth_along(std::span<const double> time_s, std::span<const double> values,
                                 Seconds window) {
    std::vector<double> smooth(values.begin(), values.end());
    const double half_s = 0.5 * window.value();
    std::size_t first = 0, end = 0;
    for (std::size_t k = 0; k < values.size(); ++k) {
        while (time_s[k] - time_s[first] > half_s) ++first;
        while (end < values.size() && time_s[end] - time_s[k] <= half_s) ++end;
        if (end - first <= 3) continue;
        double moments[5] = {}, sums[3] = {};
        for (std::size_t i = first; i < end; ++i) {
            const double u = (time_s[i] - time_s[k]) / half_s, square = u * u;
            const double weight = (1.0 - square) * (1.0 - square), value = weight * values[i];
            moments[0] += weight;
            moments[1] += weight * u;
            moments[2] += weight * square;
            moments[3] += weight * square * u;
            moments[4] += weight * square * square;
            sums[0] += value;
            sums[1] += value * u;
            sums[2] += value * square;
        }
        // Cramer's rule for the parabola's middle.
        const double a = moments[2] * moments[4] - moments[3] * moments[3],
                     b = moments[2] * moments[3] - moments[1] * moments[4],
                     c = moments[1] * moments[3] - moments[2] * moments[2];
        const double size = moments[0] * a + moments[1] * b + moments[2] * c;
        if (size > 1e-9 * moments[0] * moments[0] * moments[0])
            smooth[k] = (a * sums[0] + b * sums[1] + c * sums[2]) / size;
    }
    return smooth;
}

}  // namespace ripplenotch
