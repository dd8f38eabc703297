// SPDX-License-Identifier: MIT
// The steps of portable_math.cpp in the same order, four numbers at a time, so the bits are the same. Numbers
// that need a special case there are left to it.
#include "core/functions/many_numbers.hpp"

#include <cmath>
#include <numbers>

#include "core/functions/polynomials.hpp"
#include "core/vectors/lanes.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch::portable {
namespace {

constexpr double round_by_adding = 6755399441055744.0;  // its last bits are those of the integer added

template <class Lanes, std::size_t n>
RIPPLENOTCH_INLINED void sum_series(Lanes& sum, const std::array<double, n>& terms, const Lanes& z) {
    fill(sum, terms[n - 1]);
#pragma GCC unroll 13
    for (std::size_t i = n - 1; i > 0; --i) sum = sum * z + terms[i - 1];
}

// Numbers within 700 of 0 become their exponentials.
template <class Lanes>
RIPPLENOTCH_INLINED void to_exponential(Lanes& x) {
    const Lanes rounding = x / std::numbers::ln2 + round_by_adding;
    const Lanes power = rounding - round_by_adding;
    const Lanes rest = (x - power * ln2_high) - power * ln2_low;
    Lanes scale;
    BitsOf<Lanes> bits;
    to_bits(bits, rounding);
    from_bits(scale, (bits + 1023) << 52);
    sum_series(x, exponential_terms, rest);
    x = x * scale;
}

// Ordinary numbers above 0 become their logarithms.
template <class Lanes>
RIPPLENOTCH_INLINED void to_logarithm(Lanes& x) {
    constexpr double two_to_52 = 0x1p52;
    BitsOf<Lanes> bits;
    to_bits(bits, x);
    // The stored exponent is below 2^11, so these are the bits of 2^52 and it.
    BitsOf<Lanes> above = (bits >> 52) & 0x7ff;
    above |= 0x4330'0000'0000'0000;
    Lanes exponent, mantissa;
    from_bits(exponent, above);
    exponent -= two_to_52 + 1022.0;
    bits &= 0x000f'ffff'ffff'ffff;
    bits |= 0x3fe0'0000'0000'0000;
    from_bits(mantissa, bits);
    Lanes limit;
    fill(limit, std::numbers::sqrt2 / 2.0);
    const BitsOf<Lanes> small = mantissa < limit;
    const Lanes twice = mantissa * 2.0, one_less = exponent - 1.0;
    choose<Lanes>(mantissa, ~small, twice);
    choose<Lanes>(exponent, ~small, one_less);
    const Lanes f = (mantissa - 1.0) / (mantissa + 1.0);
    sum_series<Lanes>(x, logarithm_terms, f * f);
    x = f * 2.0 * x + exponent * std::numbers::ln2;
}

struct Exponentials {
    template <class Lanes>
    RIPPLENOTCH_INLINED static void run(const double* from, std::size_t fours, double* to) {
        for (std::size_t k = 0; k < fours * lane_count; k += lane_count) {
            Lanes x;
            load(x, from + k);
            to_exponential(x);
            store(to + k, x);
        }
    }
};

struct Logarithms {
    template <class Lanes>
    RIPPLENOTCH_INLINED static void run(const double* from, std::size_t fours, double* to) {
        for (std::size_t k = 0; k < fours * lane_count; k += lane_count) {
            Lanes x;
            load(x, from + k);
            to_logarithm(x);
            store(to + k, x);
        }
    }
};

struct HyperbolicTangents {
    template <class Lanes>
    RIPPLENOTCH_INLINED static void run(const double* from, std::size_t fours, double* to) {
        Lanes one, twenty, beyond;
        fill(one, 1.0);
        fill(twenty, 20.0);
        fill(beyond, 21.0);
        for (std::size_t k = 0; k < fours * lane_count; k += lane_count) {
            Lanes x, size;
            load(x, from + k);
            size = x;
            drop_signs(size);
            const BitsOf<Lanes> large = size > twenty;
            lower(size, beyond);
            Lanes power = size * 2.0;
            to_exponential(power);
            Lanes value = one - (one + one) / (power + 1.0);
            choose<Lanes>(value, ~large, one);
            BitsOf<Lanes> signs;
            to_bits(signs, x);
            signs &= static_cast<long long>(0x8000'0000'0000'0000U);
            flip_signs<Lanes>(value, signs);
            store(to + k, value + 0.0);  // + 0.0: no negative zero
        }
    }
};

// Powers of numbers that are 0, or ordinary; p is above 0.
struct Powers {
    template <class Lanes>
    RIPPLENOTCH_INLINED static void run(const double* from, std::size_t fours, double p, double* to) {
        Lanes zero, one;
        fill(zero, 0.0);
        fill(one, 1.0);
        for (std::size_t k = 0; k < fours * lane_count; k += lane_count) {
            Lanes x;
            load(x, from + k);
            const BitsOf<Lanes> above = x > zero;
            choose<Lanes>(x, above, one);
            to_logarithm(x);
            x = x * p;
            to_exponential(x);
            choose<Lanes>(x, above, zero);
            store(to + k, x);
        }
    }
};

template <class Allows>
bool all_are(std::span<const double> numbers, Allows allows) {
    bool all = true;
    for (const double number : numbers) all &= static_cast<bool>(allows(number));
    return all;
}

}  // namespace

void exp(std::span<const double> x, std::span<double> value) {
    const bool fast = all_are(x, [](double number) { return std::abs(number) <= 700.0; });
    const std::size_t fours = fast ? x.size() / lane_count : 0;
    in_lanes<Exponentials>(x.data(), fours, value.data());
    for (std::size_t k = fours * lane_count; k < x.size(); ++k) value[k] = exp(x[k]);
}

void log(std::span<const double> x, std::span<double> value) {
    const bool fast = all_are(x, [](double number) { return (number > 1e-300) & (number < 1e300); });
    const std::size_t fours = fast ? x.size() / lane_count : 0;
    in_lanes<Logarithms>(x.data(), fours, value.data());
    for (std::size_t k = fours * lane_count; k < x.size(); ++k) value[k] = log(x[k]);
}

void tanh(std::span<const double> x, std::span<double> value) {
    const bool fast = all_are(x, [](double number) { return std::abs(number) < 1e300; });
    const std::size_t fours = fast ? x.size() / lane_count : 0;
    in_lanes<HyperbolicTangents>(x.data(), fours, value.data());
    for (std::size_t k = fours * lane_count; k < x.size(); ++k) value[k] = tanh(x[k]);
}

void pow(std::span<const double> x, double p, std::span<double> value) {
    // What pow() itself does in another way than by logarithms.
    const bool plain = (p == std::round(p) && std::abs(p) <= 8.0) || p == 0.5;
    const bool fast = !plain && p > 0.0 && p <= 4.0 && all_are(x, [](double number) {
        return (number == 0.0) | ((number > 1e-70) & (number < 1e70) & (number != 10.0));
    });
    const std::size_t fours = fast ? x.size() / lane_count : 0;
    in_lanes<Powers>(x.data(), fours, p, value.data());
    for (std::size_t k = fours * lane_count; k < x.size(); ++k) value[k] = pow(x[k], p);
}

}  // namespace ripplenotch::portable
