// SPDX-License-Identifier: MIT
#include "analysis/kernels/point_kernel.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/vectors/lanes.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

constexpr std::size_t lanes = lane_count;

constexpr std::size_t groups = 2, at_once = groups * lanes;
constexpr std::size_t anew = 256;  // samples after which the phasors are set again, before rounding adds up

struct Phasors {
    std::array<double, at_once> real, imaginary;
};

/// Phasors at 0, 1, 2, ... times the angle.
Phasors turns_of(double angle) {
    Phasors turns{};
    for (std::size_t k = 0; k < at_once; ++k) {
        turns.real[k] = portable::cos(angle * static_cast<double>(k));
        turns.imaginary[k] = portable::sin(angle * static_cast<double>(k));
    }
    return turns;
}

struct EvenPoint {
    template <class Lanes>
    RIPPLENOTCH_INLINED static FourierPoint run(std::span<const double> where, std::span<const double> value,
                                                double middle, double step, double frequency) {
        const double radians = -2.0 * std::numbers::pi * frequency;
        const Phasors lane_turns = turns_of(radians * step);
        const double turn_real = portable::cos(radians * step * at_once),
                     turn_imaginary = portable::sin(radians * step * at_once);
        Lanes real[groups], imaginary[groups], weight, place;
        Lanes value_real[groups] = {}, value_imaginary[groups] = {}, first_real[groups] = {},
              first_imaginary[groups] = {}, second_real[groups] = {}, second_imaginary[groups] = {};
        FourierPoint point;
        for (std::size_t begin = 0; begin < where.size(); begin += anew) {
            const std::size_t end = std::min(begin + anew, where.size()),
                              even = end - (end - begin) % at_once;
            const double phase = radians * (where[begin] - middle), seed_real = portable::cos(phase),
                         seed_imaginary = portable::sin(phase);
#pragma GCC unroll 2
            for (std::size_t g = 0; g < groups; ++g) {
                load(weight, &lane_turns.real[g * lanes]);
                load(place, &lane_turns.imaginary[g * lanes]);
                real[g] = weight * seed_real - place * seed_imaginary;
                imaginary[g] = weight * seed_imaginary + place * seed_real;
            }
            for (std::size_t k = begin; k < even; k += at_once) {
#pragma GCC unroll 2
                for (std::size_t g = 0; g < groups; ++g) {
                    load(weight, value.data() + k + g * lanes);
                    load(place, where.data() + k + g * lanes);
                    place -= middle;
                    value_real[g] += weight * real[g];
                    value_imaginary[g] += weight * imaginary[g];
                    weight *= place;
                    first_real[g] += weight * real[g];
                    first_imaginary[g] += weight * imaginary[g];
                    weight *= place;
                    second_real[g] += weight * real[g];
                    second_imaginary[g] += weight * imaginary[g];
                    const Lanes turned = real[g] * turn_real - imaginary[g] * turn_imaginary;
                    imaginary[g] = real[g] * turn_imaginary + imaginary[g] * turn_real;
                    real[g] = turned;
                }
            }
            Phasors last;
            for (std::size_t g = 0; g < groups; ++g) {
                store(&last.real[g * lanes], real[g]);
                store(&last.imaginary[g * lanes], imaginary[g]);
            }
            for (std::size_t k = even; k < end; ++k) {
                const std::complex<double> phasor(last.real[k - even], last.imaginary[k - even]);
                const double at = where[k] - middle;
                point.value += value[k] * phasor;
                point.first += value[k] * at * phasor;
                point.second += value[k] * at * at * phasor;
            }
        }
#pragma GCC unroll 2
        for (std::size_t g = 0; g < groups; ++g) {
            point.value += std::complex<double>(sum(value_real[g]), sum(value_imaginary[g]));
            point.first += std::complex<double>(sum(first_real[g]), sum(first_imaginary[g]));
            point.second += std::complex<double>(sum(second_real[g]), sum(second_imaginary[g]));
        }
        return point;
    }
};

}  // namespace

FourierPoint even_point(std::span<const double> where, std::span<const double> value, double middle,
                        double step, double frequency) {
    return in_lanes<EvenPoint>(where, value, middle, step, frequency);
}

}  // namespace ripplenotch
