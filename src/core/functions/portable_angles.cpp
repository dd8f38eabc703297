// SPDX-License-Identifier: MIT
// Angles: circle functions and their inverses.
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstddef>
#include <limits>
#include <numbers>

#include "core/functions/circle_terms.hpp"
#include "core/functions/polynomial.hpp"
#include "ripplenotch/core/phasor.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch::portable {
namespace {

constexpr double pi = std::numbers::pi;

// 1, -1/3, 1/5, ... of atan(t) / t, with |t| <= 1/16: the first term left out is below 1e-20.
constexpr std::array<double, 8> arctangent_terms = [] {
    std::array<double, 8> terms{};
    for (std::size_t n = 0; n < terms.size(); ++n) {
        terms[n] = (n % 2 == 0 ? 1.0 : -1.0) / static_cast<double>(2 * n + 1);
    }
    return terms;
}();

// atan(k / 8), rounded once.
constexpr std::array<double, 9> arctangent_of_eighths = {
    0.0,
    0x1.fd5ba9aac2f6ep-4,
    0x1.f5b75f92c80ddp-3,
    0x1.6f61941e4def1p-2,
    0x1.dac670561bb4fp-2,
    0x1.1e00babdefeb4p-1,
    0x1.4978fa3269ee1p-1,
    0x1.700a7c5784634p-1,
    0x1.921fb54442d18p-1,
};

double cos_small(double x) { return polynomial(cosine_terms, x * x); }
double sin_small(double x) { return x * polynomial(sine_terms, x * x); }

struct Reduced {
    int quadrant;      ///< 0 to 3
    double remainder;  ///< within an eighth of a turn, in the unit of the angle
};

// What is no number stays none by its remainder, and has no quadrant.
int quadrant_of(double quarters) {
    return quarters == quarters ? static_cast<int>(static_cast<long long>(quarters) & 3) : 0;
}

// Exact: 90 * turns and the difference are representable, since both numbers are multiples of the angle's
// last bit.
Reduced reduce_degrees(double angle_deg) {
    if (!(std::abs(angle_deg) < 0x1p50)) angle_deg = std::fmod(angle_deg, 360.0);
    const double quarters = nearest_integer(angle_deg / 90.0);
    return {quadrant_of(quarters), angle_deg - 90.0 * quarters};
}

// pi/2 in three parts, the first two of 33 bits: their products with up to 2^20 quarters are exact (W. J.
// Cody, W. Waite, Software Manual for the Elementary Functions, 1980). What the second subtraction rounds off
// is carried on.
Reduced reduce_radians(double angle_rad) {
    constexpr double first = 0x1.921fb544p+0, second = 0x1.0b4611a6p-34, third = 0x1.3198a2e037073p-69;
    if (!(std::abs(angle_rad) < 0x1p20)) angle_rad = std::remainder(angle_rad, 2.0 * pi);
    const double quarters = nearest_integer(angle_rad * (2.0 / pi));
    const double rough = angle_rad - quarters * first;
    const double taken = quarters * second;
    const double fine = rough - taken;
    return {quadrant_of(quarters), fine + (((rough - fine) - taken) - quarters * third)};
}

// Both halves of the circle's eighths are computed and one is chosen: which, is chance, and a branch that is
// guessed wrong every other time costs more.
double cosine_in(int quadrant, double x) {
    const double even = cos_small(x), odd = sin_small(x);
    const double value = (quadrant & 1) != 0 ? odd : even;
    return ((quadrant + 1) & 2) != 0 ? -value : value;
}

double degrees_to_radians(double angle_deg) { return angle_deg * (pi / 180.0); }

// Of 0 <= x <= 1: from the nearest eighth on.
double atan_up_to_1(double x) {
    const double eighths = nearest_integer(8.0 * x);
    const double base = eighths / 8.0;
    const double t = (x - base) / (1.0 + base * x);
    return arctangent_of_eighths[static_cast<std::size_t>(eighths)] + t * polynomial(arctangent_terms, t * t);
}

}  // namespace

double cos(double angle_rad) {
    const Reduced r = reduce_radians(angle_rad);
    return cosine_in(r.quadrant, r.remainder);
}

double sin(double angle_rad) {
    if (angle_rad == 0.0) return angle_rad;
    const Reduced r = reduce_radians(angle_rad);
    return cosine_in(r.quadrant + 3, r.remainder);
}

std::complex<double> phasor(double angle_rad) {
    const Reduced r = reduce_radians(angle_rad);
    const double even = cos_small(r.remainder), odd = sin_small(r.remainder);
    const bool swapped = (r.quadrant & 1) != 0;
    const double cosine = swapped ? odd : even, sine = swapped ? even : odd;
    return {((r.quadrant + 1) & 2) != 0 ? -cosine : cosine, angle_rad == 0.0        ? angle_rad
                                                            : (r.quadrant & 2) != 0 ? -sine
                                                                                    : sine};
}

double tan(double angle_rad) {
    if (angle_rad == 0.0) return angle_rad;
    const std::complex<double> on_circle = phasor(angle_rad);
    return on_circle.imag() / on_circle.real();
}

double cos_degrees(double angle_deg) {
    const Reduced r = reduce_degrees(angle_deg);
    return cosine_in(r.quadrant, degrees_to_radians(r.remainder)) + 0.0;  // + 0.0: no negative zero
}

double sin_degrees(double angle_deg) {
    const Reduced r = reduce_degrees(angle_deg);
    return cosine_in(r.quadrant + 3, degrees_to_radians(r.remainder)) + 0.0;
}

double atan(double x) {
    if (!(std::abs(x) < std::numeric_limits<double>::infinity())) {
        return std::isnan(x) ? x : std::copysign(pi / 2.0, x);
    }
    const double size = std::abs(x);
    return std::copysign(size <= 1.0 ? atan_up_to_1(size) : pi / 2.0 - atan_up_to_1(1.0 / size), x);
}

double atan2(double y, double x) {
    if (std::isnan(x) || std::isnan(y)) return std::numeric_limits<double>::quiet_NaN();
    double height = std::abs(y), width = std::abs(x);
    if (std::isinf(height) && std::isinf(width)) height = width = 1.0;
    const bool steep = height > width;
    const double quotient = height == 0.0 && width == 0.0 ? 0.0 : steep ? width / height : height / width;
    const double inner = atan_up_to_1(quotient);
    const double first_quadrant = steep ? pi / 2.0 - inner : inner;
    return std::copysign(std::signbit(x) ? pi - first_quadrant : first_quadrant, y);
}

double asin(double x) { return atan2(x, std::sqrt((1.0 - x) * (1.0 + x))); }
double acos(double x) { return atan2(std::sqrt((1.0 - x) * (1.0 + x)), x); }

}  // namespace ripplenotch::portable
