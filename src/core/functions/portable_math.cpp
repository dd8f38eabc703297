// SPDX-License-Identifier: MIT
// Exponentials, logarithms and powers.

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "core/functions/polynomials.hpp"
#include "core/text/number.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch::portable {

namespace {

// Angles: circle functions and their inverses.

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

// For 0 <= x <= 1, from the nearest eighth on.
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

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

constexpr std::uint64_t exponent_bits = 0x7ff0000000000000U, fraction_bits = 0x000fffffffffffffU;
constexpr int bias = 1023;

// std::frexp of what is above 0, without the call.
double mantissa_of(double x, int& exponent) {
    const auto bits = std::bit_cast<std::uint64_t>(x);
    const auto stored = static_cast<int>((bits & exponent_bits) >> 52U);
    if (stored == 0 || stored == 2047 || (bits >> 63U) != 0) return std::frexp(x, &exponent);
    exponent = stored - (bias - 1);
    return std::bit_cast<double>((bits & fraction_bits) | (std::uint64_t{bias - 1} << 52U));
}

// x * 2^power, as std::ldexp, of x near 1.
double scaled(double x, int power) {
    if (power < -1020 || power > 1020) return std::ldexp(x, power);
    return x * std::bit_cast<double>(static_cast<std::uint64_t>(power + bias) << 52U);
}

// log(x) = exponent * log(2) + log_of_mantissa, with the mantissa between sqrt(1/2) and sqrt(2).
struct Logarithm {
    double of_mantissa;
    int exponent;
};

Logarithm logarithm(double x) {
    int exponent = 0;
    double mantissa = mantissa_of(x, exponent);
    if (mantissa < std::numbers::sqrt2 / 2.0) {
        mantissa *= 2.0;
        --exponent;
    }
    const double f = (mantissa - 1.0) / (mantissa + 1.0);
    return {2.0 * f * polynomial(logarithm_terms, f * f), exponent};
}

bool is_ordinary(double x) { return x > 0.0 && x < infinity; }
double log_outside(double x) { return x == 0.0 ? -infinity : x > 0.0 ? infinity : nan; }
// The exponential of what is too large or too small for a double.
double exp_outside(double x) { return std::isnan(x) ? x : x > 0.0 ? infinity : 0.0; }

double whole_power(double x, int p) {
    double product = 1.0;
    for (int i = 0; i < std::abs(p); ++i) product *= x;
    return p < 0 ? 1.0 / product : product;
}

double power_of_ten(double p) {
    if (p == nearest_integer(p) && std::abs(p) < static_cast<double>(powers_of_ten.size())) {
        const double size = powers_of_ten[static_cast<std::size_t>(std::abs(p))];
        return p < 0.0 ? 1.0 / size : size;
    }
    // log10(2) in two parts: the first has 22 trailing zero bits.
    constexpr double high = 0x1.34413508p-2, low = 0x1.f79fef311f12bp-34;
    if (!(std::abs(p) < 330.0)) return exp_outside(p);
    const double twos = nearest_integer(p / high);
    const double rest = (p - twos * high) - twos * low;
    return scaled(polynomial(exponential_terms, rest * std::numbers::ln10), static_cast<int>(twos));
}

}  // namespace

double log(double x) {
    if (!is_ordinary(x)) return log_outside(x);
    const Logarithm found = logarithm(x);
    return found.of_mantissa + found.exponent * std::numbers::ln2;
}

double log2(double x) {
    if (!is_ordinary(x)) return log_outside(x);
    const Logarithm found = logarithm(x);
    return found.of_mantissa / std::numbers::ln2 + found.exponent;
}

double log10(double x) {
    if (!is_ordinary(x)) return log_outside(x);
    const double value = log(x) / std::numbers::ln10, whole = nearest_integer(value);
    return std::abs(value - whole) < 1e-13 && x == power_of_ten(whole) ? whole : value;
}

// log(u) is exact enough of the rounded u = 1 + x; the quotient mends that rounding (W. Kahan).
double log1p(double x) {
    const double u = 1.0 + x;
    if (u == 1.0 || !is_ordinary(u)) return u == 1.0 ? x : log_outside(u);
    return log(u) * (x / (u - 1.0));
}

double exp(double x) {
    if (!(std::abs(x) < 750.0)) return exp_outside(x);
    const double power = nearest_integer(x / std::numbers::ln2);
    const double rest = (x - power * ln2_high) - power * ln2_low;
    return scaled(polynomial(exponential_terms, rest), static_cast<int>(power));
}

double exp2(double x) {
    if (!(std::abs(x) < 1100.0)) return exp_outside(x);
    const double power = nearest_integer(x);
    return scaled(polynomial(exponential_terms, (x - power) * std::numbers::ln2), static_cast<int>(power));
}

double pow(double x, double p) {
    if (p == nearest_integer(p) && std::abs(p) <= 8.0) return whole_power(x, static_cast<int>(p));
    if (x == 10.0) return power_of_ten(p);
    if (p == 0.5) return std::sqrt(x);
    if (x < 0.0) return nan;
    return exp(p * log(x));
}

double cbrt(double x) {
    if (x == 0.0 || !(std::abs(x) < infinity)) return x;
    const double guess = exp(log(std::abs(x)) / 3.0);
    return std::copysign(guess - (guess - std::abs(x) / (guess * guess)) / 3.0, x);  // a step of Newton's
}

double tanh(double x) {
    const double size = std::abs(x);
    const double value = size > 20.0 ? 1.0 : 1.0 - 2.0 / (exp(2.0 * size) + 1.0);
    return std::copysign(value, x) + 0.0;
}

// Stirling's series from 16 on, where the first term left out is below 1e-16; the recurrence leads there.
double lgamma(double x) {
    double product = 1.0;
    for (; x < 16.0; x += 1.0) product *= x;
    constexpr std::array<double, 5> terms = {1.0 / 12.0, -1.0 / 360.0, 1.0 / 1260.0, -1.0 / 1680.0,
                                             1.0 / 1188.0};
    const double series = polynomial(terms, 1.0 / (x * x)) / x;
    return (x - 0.5) * log(x) - x + 0.5 * log(2.0 * std::numbers::pi) + series - log(product);
}

double hypot(double x, double y) {
    const double larger = std::max(std::abs(x), std::abs(y));
    if (larger > 1e-140 && larger < 1e140) return std::sqrt(x * x + y * y);
    if (larger == 0.0 || !(larger < infinity)) return larger;
    return larger * std::sqrt((x / larger) * (x / larger) + (y / larger) * (y / larger));
}

double hypot(double x, double y, double z) { return hypot(hypot(x, y), z); }

}  // namespace ripplenotch::portable
