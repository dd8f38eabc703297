// SPDX-License-Identifier: MIT
#include "model/reproducible.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <numbers>

namespace ripplenotch {
namespace {

// 1.5 * 2^52: adding and subtracting it rounds a smaller number to the nearest integer, in the default
// rounding mode.
constexpr double round_by_adding = 6755399441055744.0;
double nearest_integer(double x) { return (x + round_by_adding) - round_by_adding; }

// Coefficients of 1 - z/2! + z^2/4! - ... and of 1 - z/3! + z^2/5! - ..., with z = x^2 <= (pi/4)^2: the first
// term left out is below 3e-18.
constexpr std::array<double, 9> cosine_terms = [] {
    std::array<double, 9> terms{1.0};
    for (std::size_t n = 1; n < terms.size(); ++n) {
        terms[n] = -terms[n - 1] / static_cast<double>((2 * n - 1) * (2 * n));
    }
    return terms;
}();
constexpr std::array<double, 9> sine_terms = [] {
    std::array<double, 9> terms{1.0};
    for (std::size_t n = 1; n < terms.size(); ++n) {
        terms[n] = -terms[n - 1] / static_cast<double>((2 * n) * (2 * n + 1));
    }
    return terms;
}();

// 1, 1/3, 1/5, ... of atanh(f) / f, with f^2 <= 0.0295: the first term left out is below 2e-19.
constexpr std::array<double, 12> logarithm_terms = [] {
    std::array<double, 12> terms{};
    for (std::size_t n = 0; n < terms.size(); ++n) terms[n] = 1.0 / static_cast<double>(2 * n + 1);
    return terms;
}();

// 1/n! with |x| <= ln(2)/2: the first term left out is below 5e-18.
constexpr std::array<double, 14> exponential_terms = [] {
    std::array<double, 14> terms{1.0};
    for (std::size_t n = 1; n < terms.size(); ++n) terms[n] = terms[n - 1] / static_cast<double>(n);
    return terms;
}();

template <std::size_t n>
double polynomial(const std::array<double, n>& terms, double z) {
    double sum = terms[n - 1];
    for (std::size_t i = n - 1; i > 0; --i) sum = sum * z + terms[i - 1];
    return sum;
}

double radians(double angle_deg) { return angle_deg * (std::numbers::pi / 180.0); }
double cos_small(double x) { return polynomial(cosine_terms, x * x); }
double sin_small(double x) { return x * polynomial(sine_terms, x * x); }

struct Reduced {
    int quadrant;          ///< 0 to 3
    double remainder_deg;  ///< -45 to 45
};

// Exact: 90 * turns and the difference are representable, since both numbers are multiples of the angle's
// last bit.
Reduced reduce(double angle_deg) {
    if (!(std::abs(angle_deg) < 0x1p50)) angle_deg = std::fmod(angle_deg, 360.0);
    const double turns = nearest_integer(angle_deg / 90.0);
    return {static_cast<int>(static_cast<long long>(turns) & 3), angle_deg - 90.0 * turns};
}

// Both halves of the circle's eighths are computed and one is chosen: which, is chance, and a branch that is
// guessed wrong every other time costs more.
double cosine_in(int quadrant, double x) {
    const double even = cos_small(x), odd = sin_small(x);
    const double value = (quadrant & 1) != 0 ? odd : even;
    return ((quadrant + 1) & 2) != 0 ? -value : value;
}

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

}  // namespace

double cos_degrees(double angle_deg) {
    const Reduced r = reduce(angle_deg);
    return cosine_in(r.quadrant, radians(r.remainder_deg)) + 0.0;  // + 0.0: no negative zero
}

double sin_degrees(double angle_deg) {
    const Reduced r = reduce(angle_deg);
    return cosine_in(r.quadrant + 3, radians(r.remainder_deg)) + 0.0;
}

double natural_log(double x) {
    int exponent = 0;
    double mantissa = mantissa_of(x, exponent);
    if (mantissa < std::numbers::sqrt2 / 2.0) {
        mantissa *= 2.0;
        --exponent;
    }
    const double f = (mantissa - 1.0) / (mantissa + 1.0);
    return 2.0 * f * polynomial(logarithm_terms, f * f) + exponent * std::numbers::ln2;
}

double exponential(double x) {
    // ln(2) in two parts: the first has 21 trailing zero bits, so that its product with a power up to 1024 is
    // exact.
    constexpr double ln2_high = 0x1.62e42fefap-1;
    constexpr double ln2_low = 0x1.cf79abc9e3b39p-40;
    const double power = nearest_integer(x / std::numbers::ln2);
    const double rest = (x - power * ln2_high) - power * ln2_low;
    return scaled(polynomial(exponential_terms, rest), static_cast<int>(power));
}

double power(double x, double p) {
    if (p == 1.0 || x < 1e-300) return x < 1e-300 ? 0.0 : x;
    return exponential(std::clamp(p * natural_log(x), -690.0, 690.0));
}

double smooth_sign(double x) {
    const double size = std::abs(x);
    const double value = size > 20.0 ? 1.0 : 1.0 - 2.0 / (exponential(2.0 * size) + 1.0);
    return std::copysign(value, x) + 0.0;
}

}  // namespace ripplenotch
