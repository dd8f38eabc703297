// SPDX-License-Identifier: MIT
#include "ripplenotch/core/number.hpp"

#include <fast_float/fast_float.h>
#include <fmt/compile.h>
#include <fmt/format.h>

#include <cmath>
#include <iterator>

namespace ripplenotch {

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

void append_fixed(std::string& out, double value, int decimals) {
    fmt::format_to(std::back_inserter(out), FMT_COMPILE("{:.{}f}"), value, decimals);
}

}  // namespace ripplenotch
