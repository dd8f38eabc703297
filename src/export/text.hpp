// SPDX-License-Identifier: MIT
#pragma once
// Pieces of text that several targets write.

#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "ripplenotch/core/spec.hpp"
#include "ripplenotch/export/filter_set.hpp"
#include "ripplenotch/export/target.hpp"

namespace ripplenotch {

// Reads back the output of text targets: searches from marker to marker and takes the numbers between
// brackets. It knows no values, only text.

enum class Comments { none, c, percent, hash };

class TextReader {
  public:
    /// Comments are blanked, so that numbers in them are not taken for values. `precision` is that of the
    /// target: its own compiler would round decimals to it, once.
    TextReader(std::string_view text, std::string source, Comments comments, Precision precision);

    /// Moves past the next `marker`. False, and nothing moved, when there is none.
    [[nodiscard]] bool find(std::string_view marker);
    /// The same; throws DataError naming source, line and marker when there is none.
    void expect(std::string_view marker);
    /// The next number, after blanks and '=' or ':' or ','.
    [[nodiscard]] double number();
    /// The numbers between the next `open` and its `close`; exactly `count` of them.
    [[nodiscard]] std::vector<double> numbers(char open, char close, std::size_t count);
    /// The next name or number, as text; empty at the end.
    [[nodiscard]] std::string word();
    [[noreturn]] void fail(std::string_view read, std::string_view expected) const;

  private:
    void blank_comments(Comments comments);
    [[nodiscard]] std::string_view token();

    std::string text_, source_;
    Precision precision_;
    std::size_t at_ = 0;
};

/// The bands of a file: `enter` reads what stands before the sections of one, `section` each of them in turn.
template <class Enter, class Section>
[[nodiscard]] LoadedFilters read_bands(const FilterSet& filters, const Enter& enter, const Section& section) {
    LoadedFilters found;
    for (const ExportBand& band : filters.bands) {
        enter(band);
        auto& sections = found.bands.emplace_back();
        for (std::size_t i = 0; i < band.sections.size(); ++i) sections.push_back(section(i));
    }
    return found;
}

/// A row b0 b1 b2 1 a1 a2, as SciPy and MATLAB run it.
[[nodiscard]] inline LoadedSection loaded_row(const double* v) {
    return loaded(Biquad{v[0], v[1], v[2], v[4], v[5]}, {Form::df2t, Precision::float64});
}

[[nodiscard]] inline double as_float(double value) { return static_cast<double>(static_cast<float>(value)); }

[[nodiscard]] constexpr Key precision_key(std::string_view help) {
    return {.name = "precision", .default_text = "float", .choices = "float double", .help = help};
}
inline constexpr Key speed_unit_key = {.name = "speed-unit",
                                       .default_text = "deg/s",
                                       .choices = "deg/s rad/s rpm",
                                       .help = "of the speed that the step function gets"};
inline constexpr Key speed_side_key = {
    .name = "speed-side", .default_text = "joint", .choices = "joint motor", .help = "whose speed it gets"};
/// The speed that exported code gets, by these keys.
struct CodeSpeed {
    std::string unit, side;
    std::string name;        ///< of the parameter: "motor_speed_rpm"
    double per_deg_s = 1.0;  ///< its value at a joint speed of 1 deg/s
};
[[nodiscard]] CodeSpeed code_speed(const Settings& settings, double gear_ratio);

[[nodiscard]] constexpr Key name_key(std::string_view name, std::string_view help = "prefix of all names") {
    return {.name = "name", .kind = KeyKind::text, .default_text = name, .help = help};
}

/// Shortest text that reads back exactly, with a decimal point so that C takes it for a double.
[[nodiscard]] std::string decimal(double value);
/// Nine significant digits, enough for any float, and the f that keeps C from making it a double.
[[nodiscard]] std::string decimal_float(double value);
/// "order 1, 7.5 Hz, Q 0.25" or "low-pass section at 13 Hz"
[[nodiscard]] std::string describe(const ExportSection& section);
/// "band 3: 54 < |v| <= 72 deg/s", or "at every speed"
[[nodiscard]] std::string describe(const ExportBand& band);

/// The speeds at which bands begin, or end: values of one edge, in the order of the bands.
[[nodiscard]] std::vector<double> edges(const FilterSet& filters, DegPerSec ExportBand::*edge);

/// The text with every @field@ filled in.
using Fields = std::vector<std::pair<std::string_view, std::string>>;
[[nodiscard]] std::string filled(std::string text, const Fields& fields);

/// Each line after `mark`; a line cannot end the comment or start another line.
[[nodiscard]] std::string comment_lines(std::span<const std::string> lines, std::string_view mark);

/// The same as an XML comment, in which two hyphens cannot stand.
[[nodiscard]] std::string xml_comment(std::span<const std::string> lines);

/// Throws UsageError unless `name` can be a name in C, MATLAB and YAML: letters, digits, underscores, no
/// digit first.
void check_identifier(std::string_view name, std::string_view what);

[[nodiscard]] std::string upper_case(std::string text);

/// A string of JSON; what is no printable ASCII is a question mark. The JSON library is in the module
/// document, which depends on this one; the output here is this module's own text and numbers, so that
/// quoting is all that is needed.
[[nodiscard]] std::string in_quotes(std::string_view text);

/// The filter that runs at every speed. Throws UsageError for one that is chosen by speed: `target` cannot.
[[nodiscard]] const ExportBand& only_band(const FilterSet& filters, std::string_view target);

}  // namespace ripplenotch
