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

#include "core/text/eight_digits.hpp"
#include "core/text/shortest_digits.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

constexpr std::array<double, 10> powers_of_ten = {1.0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9};

// magnitude * 10^decimals rounded to a whole number; false where that is not certain in spite of the
// product's own rounding.
bool scaled_surely(double magnitude, int decimals, std::uint64_t& scaled) {
    if (decimals < 0 || decimals >= static_cast<int>(powers_of_ten.size())) return false;
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

std::string rounded(double value, int decimals) {
    std::string text;
    append_fixed(text, value, decimals);
    const bool all_zero = text.find_first_not_of("-0.") == std::string::npos;
    return all_zero && text.front() == '-' ? text.substr(1) : text;
}

}  // namespace ripplenotch
