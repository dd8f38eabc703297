// SPDX-License-Identifier: MIT
#include "diagnose/beside/dot.hpp"

#include "core/vectors/lanes.hpp"

namespace ripplenotch {
namespace {

struct Dot {
    template <class Lanes>
    RIPPLENOTCH_INLINED static double run(const double* a, const double* b, std::size_t count) {
        // Two sums at a time hide how long an addition takes.
        Lanes first{}, second{}, a0, a1, b0, b1;
        std::size_t k = 0;
        for (; k + 2 * lane_count <= count; k += 2 * lane_count) {
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
};

struct AddScaled {
    template <class Lanes>
    RIPPLENOTCH_INLINED static void run(double factor, const double* from, double* to, std::size_t count) {
        Lanes by, x, y;
        fill(by, factor);
        std::size_t k = 0;
        for (; k + lane_count <= count; k += lane_count) {
            load(x, from + k);
            load(y, to + k);
            y += by * x;
            store(to + k, y);
        }
        for (; k < count; ++k) to[k] += factor * from[k];
    }
};

}  // namespace

double dot(const double* a, const double* b, std::size_t count) { return in_lanes<Dot>(a, b, count); }

void add_scaled(double factor, const double* from, double* to, std::size_t count) {
    in_lanes<AddScaled>(factor, from, to, count);
}

}  // namespace ripplenotch
