// SPDX-License-Identifier: MIT
#include "ripplenotch/core/number.hpp"

#include <fast_float/fast_float.h>
#include <fmt/compile.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
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
    const fmt::format_int digits(*scaled);
    std::array<char, 32> text;
    char* at = text.data();
    if (std::signbit(value)) *at++ = '-';
    const int before = static_cast<int>(digits.size()) - decimals;  // the decimal mark
    if (before > 0) {
        at = std::copy_n(digits.data(), before, at);
        if (decimals > 0) *at++ = '.';
        at = std::copy_n(digits.data() + before, decimals, at);
    } else {
        at = std::fill_n(std::copy_n("0.", 2, at), -before, '0');
        at = std::copy_n(digits.data(), digits.size(), at);
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
