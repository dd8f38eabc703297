// SPDX-License-Identifier: MIT
#include "ripplenotch/core/number.hpp"

#include <fast_float/fast_float.h>
#include <fmt/compile.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
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
    const double whole = std::floor(scaled), rest = scaled - whole;
    // The product is off by at most half a unit in its last place, 1.2e-16 of itself.
    if (std::abs(rest - 0.5) <= 4e-16 * scaled) return std::nullopt;
    return static_cast<std::uint64_t>(whole) + (rest > 0.5 ? 1 : 0);
}

constexpr auto digit_pairs = [] {
    std::array<char, 200> pairs{};
    for (std::size_t i = 0; i < 100; ++i) {
        pairs[2 * i] = static_cast<char>('0' + i / 10);
        pairs[2 * i + 1] = static_cast<char>('0' + i % 10);
    }
    return pairs;
}();

/// The last `count` digits of a number, zeros before it where it is short, ending just before `end`.
void write_digits(char* end, std::uint64_t value, int count) {
    for (; count >= 2; count -= 2, value /= 100) {
        end -= 2;
        std::memcpy(end, digit_pairs.data() + 2 * (value % 100), 2);
    }
    if (count > 0) *--end = static_cast<char>('0' + value % 10);
}

int digits_in(std::uint64_t value) {
    int count = 1;
    for (std::uint64_t bound = 10; value >= bound && count < 19; bound *= 10) ++count;
    return count;
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

std::string shortest(double value) { return fmt::format(FMT_COMPILE("{}"), value); }

void append_shortest(std::string& out, double value) {
    fmt::format_to(std::back_inserter(out), FMT_COMPILE("{}"), value);
}

// Printing a whole number and setting the mark takes a third of the time of exact decimal printing, which is
// left for what lies too near a tie, is large, or has many decimals.
void append_fixed(std::string& out, double value, int decimals) {
    const auto scaled = scaled_surely(std::abs(value), decimals);
    if (!scaled) {
        fmt::format_to(std::back_inserter(out), FMT_COMPILE("{:.{}f}"), value, decimals);
        return;
    }
    const auto unit = static_cast<std::uint64_t>(powers_of_ten[static_cast<std::size_t>(decimals)]);
    const std::uint64_t whole = *scaled / unit, fraction = *scaled % unit;
    std::array<char, 32> text;
    char* at = text.data();
    if (std::signbit(value)) *at++ = '-';
    const int before = digits_in(whole);
    write_digits(at += before, whole, before);
    if (decimals > 0) {
        *at++ = '.';
        write_digits(at += decimals, fraction, decimals);
    }
    out.append(text.data(), static_cast<std::size_t>(at - text.data()));
}

std::string rounded(double value, int decimals) {
    std::string text;
    append_fixed(text, value, decimals);
    const bool all_zero = text.find_first_not_of("-0.") == std::string::npos;
    return all_zero && text.front() == '-' ? text.substr(1) : text;
}

}  // namespace ripplenotch
