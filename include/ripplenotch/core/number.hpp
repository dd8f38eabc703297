// SPDX-License-Identifier: MIT
#pragma once
// Numbers as text: strict, independent of the locale, exact in both directions.

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace ripplenotch {

// The median, in one place: the upper of the middle two.

/// Puts the values in another order. 0 when there are none.
[[nodiscard]] inline double median_in(std::span<double> values) {
    if (values.empty()) return 0.0;
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

/// Standard deviations in the median of what normal values are off by.
inline constexpr double deviations_of_median = 1.4826;

[[nodiscard]] inline double median_of(std::vector<double> values) { return median_in(values); }

/// A percentage as people print it, two significant digits and no exponent: "0.16", "4.2", "38", "100", and
/// "0" for none, never "-0.0" or "1e+02". Without the sign.
[[nodiscard]] std::string percent_text(double percent);

/// "1 gap", "2 gaps"; `many` where an s does not make the plural: "2 switches".
[[nodiscard]] inline std::string how_many(std::size_t count, std::string_view one,
                                          std::string_view many = {}) {
    if (count == 1) return fmt::format("1 {}", one);
    return many.empty() ? fmt::format("{} {}s", count, one) : fmt::format("{} {}", count, many);
}

inline constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

/// Reads one finite or non-finite decimal number that fills `text` entirely (a leading '+' is allowed, white
/// space is not). Correctly rounded. `decimal_mark` is '.' or ','. Empty when the text is not a number or
/// overflows a double.
[[nodiscard]] std::optional<double> parse_number(std::string_view text, char decimal_mark = '.');

/// mantissa * 10^exponent, correctly rounded; empty in the rare cases where that takes more than the 128 bits
/// of Lemire's method (Number parsing at a gigabyte per second, 2021), and outside the range of a double.
[[nodiscard]] std::optional<double> decimal_number(std::uint64_t mantissa, int exponent);

/// The shortest text that reads back as the same double, e.g. "0.1", "1e+30", "nan", "-inf".
[[nodiscard]] std::string shortest(double value);

/// Bytes that put_shortest() and put_fixed() may use of where they write to, for any value.
inline constexpr std::size_t number_room = 352;
/// shortest(value) at `into`; returns its end. For inner loops.
char* put_shortest(char* into, double value);
/// append_fixed() at `into`; returns its end.
char* put_fixed(char* into, double value, int decimals);

/// Appends shortest(value) to `out`; for inner loops.
void append_shortest(std::string& out, double value);

/// Appends `value` with exactly `decimals` digits after the mark, rounded as printf does.
void append_fixed(std::string& out, double value, int decimals);

/// Digits that fitted numbers are written with: a thousand times finer than any torque sensor, and a thousand
/// times coarser than what processors disagree on where a library chooses its way by them
/// (docs/decisions/0004-same-bytes.md).
inline constexpr int fitted_digits = 9;
/// The nearest number with so many digits; not finite ones stay.
[[nodiscard]] double to_digits(double value, int digits = fitted_digits);
/// A value of a row, and the largest of the row.
struct ValueInRow {
    double value = 0.0, largest = 0.0;
};
/// The same in steps that suit the largest: what a transform leaves where nothing is comes out as 0.
[[nodiscard]] double to_digits_in_row(const ValueInRow& cell, int digits = fitted_digits);

/// As many decimals as `error` (above 0) has so many digits; none where it is larger.
[[nodiscard]] int decimals_of(double error, int digits);
/// "0.5998 +/- 0.0024": two digits of the error, and as many decimals of the value.
[[nodiscard]] std::string with_error(double value, double error);

/// A figure for people: `decimals` digits after the mark, and no sign where all of them are zero.
[[nodiscard]] std::string rounded(double value, int decimals);

}  // namespace ripplenotch
