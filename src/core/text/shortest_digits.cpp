// SPDX-License-Identifier: MIT
// A double is c * 2^q, and every number between (c - 1/2) * 2^q and (c + 1/2) * 2^q reads back as it. Scaled
// by the 10^n for which 1 <= 2^q * 10^n < 10, this interval holds a whole number, and at most one multiple of
// ten: if there is one, it has the fewest digits, else the whole number nearest to the middle has (R.
// Giulietti, The Schubfach way to render doubles, 2020). In the range taken here 5^n is a 64-bit number, so
// all products are exact, and no end of the interval is a multiple of ten: twice its distance is even, 5^n is
// odd.
#include "core/text/shortest_digits.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "core/text/eight_digits.hpp"

namespace ripplenotch {
namespace {

__extension__ using Wide = unsigned __int128;

constexpr int least_exponent = -13, most_exponent = 25;  // of two, in the number's magnitude
constexpr int mantissa_bits = 52;
constexpr std::uint64_t ten_to_16 = 10'000'000'000'000'000, ten_to_8 = 100'000'000;

/// What numbers of one binary exponent are scaled with.
struct Scale {
    std::uint64_t five_to_n = 1;
    int decimals = 0;            ///< n
    int shift = 0;               ///< c * 5^n / 2^shift is the number times 10^n
    std::uint64_t ten_to_n = 0;  ///< for n up to 16, as below
    std::uint64_t to_16 = 0;     ///< 10^(16 - n)
};

constexpr auto scales = [] {
    std::array<Scale, most_exponent - least_exponent + 1> all;
    for (int exponent = least_exponent; exponent <= most_exponent; ++exponent) {
        const int q = exponent - mantissa_bits;
        Scale& scale = all[static_cast<std::size_t>(exponent - least_exponent)];
        Wide ten_to_n = 1;
        for (; ten_to_n < Wide{1} << -q; ten_to_n *= 10) {
            ++scale.decimals;
            scale.five_to_n *= 5;
        }
        scale.shift = -q - scale.decimals;
        if (scale.decimals > 16) continue;
        scale.ten_to_n = static_cast<std::uint64_t>(ten_to_n);
        scale.to_16 = ten_to_16 / scale.ten_to_n;
    }
    return all;
}();

/// The decimal with the fewest digits, times 10^n: sixteen digits or seventeen, zeros at its end included.
std::uint64_t fewest_digits(std::uint64_t c, const Scale& scale) {
    const Wide scaled = Wide{c} * scale.five_to_n;
    const auto whole = static_cast<std::uint64_t>(scaled >> scale.shift);
    const std::uint64_t one = std::uint64_t{1} << scale.shift;
    const std::uint64_t fraction = static_cast<std::uint64_t>(scaled) & (one - 1);
    const std::uint64_t tens = whole / 10 * 10;
    const std::uint64_t above_tens = (whole - tens) * one + fraction;
    // Half the interval is 5^n / 2^(shift + 1).
    const bool tens_inside = 2 * above_tens < scale.five_to_n;
    const bool next_inside = 2 * (10 * one - above_tens) < scale.five_to_n;
    // As good as coin's tosses, so no branches.
    const std::uint64_t up = fraction + (whole & 1) > one / 2 ? 1 : 0;  // halves to even
    const std::uint64_t nearest = whole + up, nearest_ten = tens + (next_inside ? 10 : 0);
    const std::uint64_t take_ten = ~std::uint64_t{0} * static_cast<std::uint64_t>(tens_inside | next_inside);
    return nearest ^ ((nearest ^ nearest_ten) & take_ten);
}

/// Sixteen digits; returns how many of them are zeros at the end.
int put_sixteen(char* into, std::uint64_t digits) {
    const std::uint64_t first = eight_digits(static_cast<std::uint32_t>(digits / ten_to_8));
    const std::uint64_t last = eight_digits(static_cast<std::uint32_t>(digits % ten_to_8));
    put_eight(into, first + eight_zeros);
    put_eight(into + 8, last + eight_zeros);
    return last != 0 ? std::countl_zero(last) / 8 : 8 + std::countl_zero(first) / 8;
}

/// A number below 1e8.
char* put_whole(char* into, std::uint32_t number) {
    if (number < 10) {
        *into = static_cast<char>('0' + number);
        return into + 1;
    }
    const std::uint64_t digits = eight_digits(number);
    const int leading = std::min(std::countr_zero(digits) / 8, 7);
    put_eight(into, (digits + eight_zeros) >> (8 * leading));
    return into + 8 - leading;
}

}  // namespace

char* put_usual_shortest(char* into, double value) {
    const auto bits = std::bit_cast<std::uint64_t>(value);
    const std::uint64_t hidden_bit = std::uint64_t{1} << mantissa_bits;
    const std::uint64_t mantissa = bits & (hidden_bit - 1);
    const auto index = static_cast<std::size_t>((bits >> mantissa_bits) & 0x7FF) -
                       static_cast<std::size_t>(1023 + least_exponent);
    // Below a power of two the interval is half as wide as above it.
    if (index >= scales.size() || mantissa == 0) return nullptr;
    const Scale& scale = scales[index];
    const std::uint64_t digits = fewest_digits(mantissa | hidden_bit, scale);
    *into = '-';
    into += bits >> 63;
    if (scale.decimals <= 16) {
        // No decimal inside the interval has another whole part: that one is a double of its own.
        const auto whole = static_cast<std::uint32_t>(std::abs(value));
        const std::uint64_t fraction = (digits - whole * scale.ten_to_n) * scale.to_16;
        into = put_whole(into, whole);
        *into = '.';
        return fraction == 0 ? into : into + 17 - put_sixteen(into + 1, fraction);
    }
    put_eight(into, std::uint64_t{'.'} << 8 | (eight_zeros & ~std::uint64_t{0xFF00}));  // 0.000000
    into += 2 + scale.decimals - 17;
    *into++ = static_cast<char>('0' + digits / ten_to_16);
    return into + 16 - put_sixteen(into, digits % ten_to_16);
}

}  // namespace ripplenotch
