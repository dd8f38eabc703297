// SPDX-License-Identifier: MIT
#include "diagnose/beside/dot.hpp"

#include "core/lanes.hpp"

namespace ripplenotch {

RIPPLENOTCH_FOR_AVX2_TOO
double dot(const double* a, const double* b, std::size_t count) {
    // Two sums at a time hide how long an addition takes.
    Four first{}, second{};
    std::size_t k = 0;
    for (; k + 2 * lane_count <= count; k += 2 * lane_count) {
        Four a0, a1, b0, b1;
        load(a0, a + k);
        load(b0, b + k);
        load(a1, a + k + lane_count);
        load(b1, b + k + lane_count);
        first += a0 * b0;
        second += a1 * b1;
    }
    double rest = 0.0;
    for (; k < count; ++k) rest += a[k] * b[k];
    first += second;
    return sum(first) + rest;
}

RIPPLENOTCH_FOR_AVX2_TOO
void add_scaled(double factor, const double* from, double* to, std::size_t count) {
    Four by;
    fill(by, factor);
    std::size_t k = 0;
    for (; k + lane_count <= count; k += lane_count) {
        Four x, y;
        load(x, from + k);
        load(y, to + k);
        y += by * x;
        store(to + k, y);
    }
    for (; k < count; ++k) to[k] += factor * from[k];
}

}  // namespace ripplenotch
