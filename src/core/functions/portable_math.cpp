// SPDX-License-Identifier: MIT
// Exponentials, logarithms and powers.
#include "ripplenotch/core/portable_math.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numbers>

#include "core/functions/polynomial.hpp"
#include "core/functions/power_terms.hpp"

namespace ripplenotch::portable {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

// Powers of ten that are exact.
constexpr std::array<double, 23> powers_of_ten = [] {
    std::array<double, 23> powers{1.0};
    for (std::size_t n = 1; n < powers.size(); ++n) powers[n] = 10.0 * powers[n - 1];
    return powers;
}();

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
// Of what exponentials cannot hold.
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
