// SPDX-License-Identifier: MIT
#include "core/vectors/dot.hpp"

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

struct AddDots {
    template <class Lanes>
    RIPPLENOTCH_INLINED static void run(const double* a0, const double* a1, const double* b0,
                                        const double* b1, std::size_t count, double* sums) {
        Lanes sum00{}, sum01{}, sum10{}, sum11{}, x0, x1, y0, y1;
        std::size_t k = 0;
        for (; k + lane_count <= count; k += lane_count) {
            load(x0, a0 + k);
            load(x1, a1 + k);
            load(y0, b0 + k);
            load(y1, b1 + k);
            sum00 += x0 * y0;
            sum01 += x0 * y1;
            sum10 += x1 * y0;
            sum11 += x1 * y1;
        }
        double rest[4] = {};
        for (; k < count; ++k) {
            rest[0] += a0[k] * b0[k];
            rest[1] += a0[k] * b1[k];
            rest[2] += a1[k] * b0[k];
            rest[3] += a1[k] * b1[k];
        }
        sums[0] += sum(sum00) + rest[0];
        sums[1] += sum(sum01) + rest[1];
        sums[2] += sum(sum10) + rest[2];
        sums[3] += sum(sum11) + rest[3];
    }
};

struct PredictionErrors {
    template <class Lanes>
    RIPPLENOTCH_INLINED static void run(const double* signal, std::size_t count, const double* weights,
                                        std::size_t memory, double* to) {
        // Each sum is in the order of the weights; four registers of sums hide how long an addition takes.
        Lanes by{}, a{}, b{}, c{}, d{};
        std::size_t k = 0;
        for (; k + 4 * lane_count <= count; k += 4 * lane_count) {
            Lanes sum_a{}, sum_b{}, sum_c{}, sum_d{};
            const double* before = signal + k;
            for (std::size_t i = 0; i < memory; ++i) {
                --before;
                fill(by, weights[i]);
                load(a, before);
                load(b, before + lane_count);
                load(c, before + 2 * lane_count);
                load(d, before + 3 * lane_count);
                sum_a += by * a;
                sum_b += by * b;
                sum_c += by * c;
                sum_d += by * d;
            }
            load(a, signal + k);
            load(b, signal + k + lane_count);
            load(c, signal + k + 2 * lane_count);
            load(d, signal + k + 3 * lane_count);
            store(to + k, a - sum_a);
            store(to + k + lane_count, b - sum_b);
            store(to + k + 2 * lane_count, c - sum_c);
            store(to + k + 3 * lane_count, d - sum_d);
        }
        for (; k < count; ++k) {
            double sum = 0.0;
            for (std::size_t i = 0; i < memory; ++i)
                sum +=
                    weights[i] * signal[static_cast<std::ptrdiff_t>(k) - 1 - static_cast<std::ptrdiff_t>(i)];
            to[k] = signal[k] - sum;
        }
    }
};

}  // namespace

double dot(const double* a, const double* b, std::size_t count) { return in_lanes<Dot>(a, b, count); }

void add_scaled(double factor, const double* from, double* to, std::size_t count) {
    in_lanes<AddScaled>(factor, from, to, count);
}

void add_dots(const double* const (&a)[2], const double* const (&b)[2], std::size_t count,
              double (&sums)[4]) {
    in_lanes<AddDots>(a[0], a[1], b[0], b[1], count, static_cast<double*>(sums));
}

void prediction_errors(const double* signal, std::size_t count, const double* weights, std::size_t memory,
                       double* to) {
    in_lanes<PredictionErrors>(signal, count, weights, memory, to);
}

}  // namespace ripplenotch
