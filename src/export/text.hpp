// SPDX-License-Identifier: MIT
#pragma once
// Pieces of text that several targets write.

#include <span>
#include <string>
#include <string_view>

#include "ripplenotch/export/filter_set.hpp"

namespace ripplenotch {

/// Shortest text that reads back exactly, with a decimal point so that C takes it for a double.
[[nodiscard]] std::string decimal(double value);
/// Nine significant digits, enough for any float, and the f that keeps C from making it a double.
[[nodiscard]] std::string decimal_float(double value);
/// C99 hexadecimal literals of finite numbers: exact, whoever reads them.
[[nodiscard]] std::string hexadecimal(double value);
[[nodiscard]] std::string hexadecimal_float(double value);

/// "order 1, 7.5 Hz, Q 0.25" or "low-pass section at 13 Hz"
[[nodiscard]] std::string describe(const ExportSection& section);
/// "band 3: 54 < |v| <= 72 deg/s", or "at every speed"
[[nodiscard]] std::string describe(const ExportBand& band);

/// Each line after `mark`; a line cannot end the comment or start another line.
[[nodiscard]] std::string comment_lines(std::span<const std::string> lines, std::string_view mark);

/// Throws UsageError unless `name` can be a name in C, MATLAB and YAML: letters, digits, underscores, no
/// digit first.
void check_identifier(std::string_view name, std::string_view what);

[[nodiscard]] std::string upper_case(std::string text);

/// The filter that runs at every speed. Throws UsageError for one that is chosen by speed: `target` cannot.
[[nodiscard]] const ExportBand& only_band(const FilterSet& filters, std::string_view target);

}  // namespace ripplenotch
