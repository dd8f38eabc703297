// SPDX-License-Identifier: MIT
#include "ripplenotch/core/number.hpp"

#include <fast_float/fast_float.h>
#include <fmt/compile.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <iterator>

namespace ripplenotch {
namespace {

constexpr std::array<double, 10> powers_of_ten = {1.0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9};

// magnitude * 10^decimals rounded to a whole number, where that is certain in spite of the product's own
// rounding.
std::optional<std::uint64_t> scaled_surely(double magnitude, int decimals) {
    if (decimals < 0 || decimals >= static_cast<int>(powers_of_ten.size())) return std::nullopt;
    const double scaled = magnitude * powers_of_ten[static_cast<std::size_t>(decimals)];
    if (!(scaled < 1e15)) return std::nullopt;
    const auto whole = static_cast<std::int64_t>(scaled);
    const double rest = scaled - static_cast<double>(whole);
    // The product is off by at most half a unit in its last place, 1.2e-16 of itself.
    if (std::abs(rest - 0.5) <= 4e-16 * scaled) return std::nullopt;
    return static_cast<std::uint64_t>(whole) + (rest > 0.5 ? 1 : 0);
}

/// The eight digits of a number below 1e8, one a byte, the first in the lowest: halves of it side by side,
/// then halves of these, each division by 10000, 100 and 10 a multiplication.
std::uint64_t eight_digits(std::uint32_t value) {
    std::uint64_t parts = value / 10000 | static_cast<std::uint64_t>(value % 10000) << 32;
    std::uint64_t upper = ((parts * 10486) >> 20) & 0x0000007F0000007FU;
    parts = upper | (parts - 100 * upper) << 16;
    upper = ((parts * 103) >> 10) & 0x000F000F000F000FU;
    return upper | (parts - 10 * upper) << 8;
}

void put_text(char* into, std::uint64_t digits) {
    digits += 0x3030303030303030U;
    if constexpr (std::endian::native == std::endian::big) digits = __builtin_bswap64(digits);
    std::memcpy(into, &digits, 8);
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

char* put_shortest(char* into, double value) { return fmt::format_to(into, FMT_COMPILE("{}"), value); }

// Printing a whole number and setting the mark takes a tenth of the time of exact decimal printing, which is
// left for what lies too near a tie, is large, or has many decimals.
char* put_fixed(char* into, double value, int decimals) {
    const auto scaled = scaled_surely(std::abs(value), decimals);
    if (!scaled) return fmt::format_to(into, FMT_COMPILE("{:.{}f}"), value, decimals);
    const std::uint64_t upper = eight_digits(static_cast<std::uint32_t>(*scaled / 100000000));
    const std::uint64_t lower = eight_digits(static_cast<std::uint32_t>(*scaled % 100000000));
    std::array<char, 32> digits;  // sixteen, and what is copied behind them
    put_text(digits.data(), upper);
    put_text(digits.data() + 8, lower);
    const auto zeros = [](std::uint64_t eight) {
        return static_cast<std::size_t>(std::countr_zero(eight)) / 8;
    };
    const std::size_t leading = upper != 0 ? zeros(upper) : 8 + zeros(lower);
    const std::size_t mark = 16 - static_cast<std::size_t>(decimals);
    const std::size_t first = std::min(leading, mark - 1);
    if (std::signbit(value)) *into++ = '-';
    std::memcpy(into, digits.data() + first, 16);
    into += mark - first;
    if (decimals == 0) return into;
    *into++ = '.';
    std::memcpy(into, digits.data() + mark, 16);
    return into + decimals;
}

void append_shortest(std::string& out, double value) {
    std::array<char, number_room> text;
    out.append(text.data(), put_shortest(text.data(), value));
}

void append_fixed(std::string& out, double value, int decimals) {
    std::array<char, number_room> text;
    out.append(text.data(), put_fixed(text.data(), value, decimals));
}

std::string rounded(double value, int decimals) {
    std::string text;
    append_fixed(text, value, decimals);
    const bool all_zero = text.find_first_not_of("-0.") == std::string::npos;
    return all_zero && text.front() == '-' ? text.substr(1) : text;
}

}  // namespace ripplenotch
