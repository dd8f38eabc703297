// SPDX-License-Identifier: MIT
#include "core/text/number.hpp"

#include <fast_float/fast_float.h>
#include <fmt/compile.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>

#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {

std::string percent_text(double percent) {
    constexpr double min_whole = 9.95,
                     min_shown = 1e-4;  // below, a format of its own would have exponents
    if (std::abs(percent) >= min_whole) return fmt::format("{:.0f}", percent);
    if (std::abs(percent) < min_shown) return "0";
    return fmt::format("{:.2g}", percent);
}

namespace {

// Eight decimal digits at a time, in a register.

/// From numbers side by side, each split into quotient (in its lower half) and remainder (in its upper half)
/// by `divisor`: parts << half | quotients, less divisor times the quotients in the upper half.
constexpr std::uint64_t split_digits(std::uint64_t parts, std::uint64_t quotients, std::uint64_t divisor,
                                     int half) {
    return (parts << half) - quotients * ((divisor << half) - 1);
}

/// The eight digits of a number below 1e8, one a byte, the first in the lowest: halves of it side by side,
/// then halves of these, each division by 10000, 100 and 10 a multiplication.
constexpr std::uint64_t eight_digits(std::uint32_t value) {
    const std::uint64_t fours = split_digits(value, value / 10000, 10000, 32);
    const std::uint64_t twos = split_digits(fours, ((fours * 10486) >> 20) & 0x0000007F0000007FU, 100, 16);
    return split_digits(twos, ((twos * 103) >> 10) & 0x000F000F000F000FU, 10, 8);
}

/// Digits as characters.
constexpr std::uint64_t eight_zeros = 0x3030303030303030U;

/// Eight characters, the first in the lowest byte.
void put_eight(char* into, std::uint64_t text) {
    if constexpr (std::endian::native == std::endian::big) text = __builtin_bswap64(text);
    std::memcpy(into, &text, sizeof text);
}

// A double is c * 2^q, and every number between (c - 1/2) * 2^q and (c + 1/2) * 2^q reads back as it. Scaled
// by the 10^n for which 1 <= 2^q * 10^n < 10, this interval holds a whole number, and at most one multiple of
// ten: if there is one, it has the fewest digits, else the whole number nearest to the middle has (R.
// Giulietti, The Schubfach way to render doubles, 2020). In the range taken here 5^n is a 64-bit number, so
// all products are exact, and no end of the interval is a multiple of ten: twice its distance is even, 5^n is
// odd.

__extension__ using Wide = unsigned __int128;

constexpr int min_exponent = -13, max_exponent = 25;  // of two, in the number's magnitude
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
    std::array<Scale, max_exponent - min_exponent + 1> all;
    for (int exponent = min_exponent; exponent <= max_exponent; ++exponent) {
        const int q = exponent - mantissa_bits;
        Scale& scale = all[static_cast<std::size_t>(exponent - min_exponent)];
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
                       static_cast<std::size_t>(1023 + min_exponent);
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

namespace {

constexpr int max_decimals_scaled = 9;

// magnitude * 10^decimals rounded to a whole number; false where that is not certain in spite of the
// product's own rounding.
bool scaled_surely(double magnitude, int decimals, std::uint64_t& scaled) {
    if (decimals < 0 || decimals > max_decimals_scaled) return false;
    const double product = magnitude * powers_of_ten[static_cast<std::size_t>(decimals)];
    if (!(product < 1e15)) return false;
    const auto whole = static_cast<std::int64_t>(product);
    const double short_of_half = 0.5 - (product - static_cast<double>(whole));
    // As good as a coin's toss, so not a branch.
    scaled = static_cast<std::uint64_t>(whole) + (std::signbit(short_of_half) ? 1U : 0U);
    // The product is off by at most half a unit in its last place, 1.2e-16 of itself.
    return std::abs(short_of_half) > 4e-16 * product;
}

/// Exact decimal printing, for what lies too near a tie, is large, or has many decimals.
[[gnu::noinline]] char* put_exactly(char* into, double value, int decimals) {
    return fmt::format_to(into, FMT_COMPILE("{:.{}f}"), value, decimals);
}

/// A number below 1e8 with 1 to 7 decimals: what comes first is shifted out, so that nothing takes the way
/// through memory.
char* put_short(char* into, std::uint32_t scaled, int decimals) {
    const std::uint64_t digits = eight_digits(scaled);
    const int leading = std::min(std::countr_zero(digits) / 8, 7 - decimals);
    const std::uint64_t text = digits + eight_zeros;
    put_eight(into, text >> (8 * leading));
    into += 8 - decimals - leading;
    *into++ = '.';
    put_eight(into, text >> (8 * (8 - decimals)));
    return into + decimals;
}

/// Any other of up to sixteen digits. Not inline, nor is the exact way: the usual way needs no stack then.
[[gnu::noinline]] char* put_long(char* into, std::uint64_t scaled, int decimals) {
    std::array<char, 17> text;
    put_eight(text.data(), eight_digits(static_cast<std::uint32_t>(scaled / 100000000)) + eight_zeros);
    put_eight(text.data() + 8, eight_digits(static_cast<std::uint32_t>(scaled % 100000000)) + eight_zeros);
    const auto mark = text.begin() + 16 - decimals;
    const auto first = std::find_if(text.begin(), mark - 1, [](char digit) { return digit != '0'; });
    into = std::copy(first, mark, into);
    if (decimals > 0) *into++ = '.';
    return std::copy(mark, text.begin() + 16, into);
}

}  // namespace

std::optional<double> parse_number(std::string_view text, char decimal_mark) {
    if (!text.empty() && text.front() == '+') {
        text.remove_prefix(1);
        if (!text.empty() && (text.front() == '-' || text.front() == '+')) return std::nullopt;
    }
    if (text.empty()) return std::nullopt;
    double value = 0.0;
    const char* const end = text.data() + text.size();
    const auto result = fast_float::from_chars_advanced(
        text.data(), end, value, fast_float::parse_options(fast_float::chars_format::general, decimal_mark));
    if (result.ec != std::errc() || result.ptr != end) return std::nullopt;
    // fast_float reports overflow as infinity without an error; a written "inf" keeps its letters.
    const bool spelled = text.back() == 'f' || text.back() == 'F' || text.back() == 'y' || text.back() == 'Y';
    if (std::isinf(value) && !spelled) return std::nullopt;
    return value;
}

std::optional<double> decimal_number(std::uint64_t mantissa, int exponent) {
    using Binary = fast_float::binary_format<double>;
    const auto parts = fast_float::compute_float<Binary>(exponent, mantissa);
    if (parts.power2 < 0 || parts.power2 >= Binary::infinite_power()) return std::nullopt;
    return std::bit_cast<double>(parts.mantissa | static_cast<std::uint64_t>(parts.power2)
                                                      << Binary::mantissa_explicit_bits());
}

std::string shortest(double value) { return fmt::format(FMT_COMPILE("{}"), value); }

char* put_shortest(char* into, double value) {
    char* const end = put_usual_shortest(into, value);
    return end != nullptr ? end : fmt::format_to(into, FMT_COMPILE("{}"), value);
}

// Printing a whole number and setting the mark takes a tenth of the time of exact decimal printing, which is
// left for what lies too near a tie, is large, or has many decimals.
char* put_fixed(char* into, double value, int decimals) {
    std::uint64_t scaled = 0;
    if (!scaled_surely(std::abs(value), decimals, scaled)) return put_exactly(into, value, decimals);
    *into = '-';
    into += std::signbit(value) ? 1 : 0;
    const bool is_short = scaled < 100000000 && decimals > 0 && decimals < 8;
    return is_short ? put_short(into, static_cast<std::uint32_t>(scaled), decimals)
                    : put_long(into, scaled, decimals);
}

void append_shortest(std::string& out, double value) {
    std::array<char, number_room> text;
    out.append(text.data(), put_shortest(text.data(), value));
}

void append_fixed(std::string& out, double value, int decimals) {
    std::array<char, number_room> text;
    out.append(text.data(), put_fixed(text.data(), value, decimals));
}

double to_digits(double value, int digits) {
    if (!std::isfinite(value)) return value;
    return parse_number(fmt::format("{:.{}g}", value, digits)).value_or(value);
}

double to_digits_in_row(const ValueInRow& cell, int digits) {
    const auto [value, largest] = cell;
    if (!std::isfinite(value) || !std::isnormal(largest)) return value;
    const int places = digits - 1 - static_cast<int>(std::floor(portable::log10(std::abs(largest))));
    if (places < 0 || places > 300) return to_digits(value, digits);
    return parse_number(fmt::format("{:.{}f}", value, places)).value_or(value) +
           0.0;  // + 0.0: no negative zero
}

int decimals_of(double error, int digits) {
    return std::max(0, digits - 1 - static_cast<int>(std::floor(portable::log10(error))));
}

std::string with_error(double value, double error) {
    constexpr int error_digits = 2;
    if (!(error > 0.0) || !std::isfinite(error)) return fmt::format("{:.4g} +/- {:.2g}", value, error);
    const int decimals = decimals_of(error, error_digits);
    // Beyond these an exponent is read faster than zeros are counted.
    constexpr int max_decimals = 7;
    constexpr double largest_error = 100.0;
    if (decimals <= max_decimals && error < largest_error)
        return fmt::format("{} +/- {}", rounded(value, decimals), rounded(error, decimals));
    const double size = std::max(std::abs(value), error);
    const int digits = error_digits + static_cast<int>(std::floor(portable::log10(size)) -
                                                       std::floor(portable::log10(error)));
    return fmt::format("{:.{}g} +/- {:.{}g}", value, digits, error, error_digits);
}

std::string rounded(double value, int decimals) {
    std::string text;
    append_fixed(text, value, decimals);
    const bool all_zero = text.find_first_not_of("-0.") == std::string::npos;
    return all_zero && text.front() == '-' ? text.substr(1) : text;
}

}  // namespace ripplenotch
