// SPDX-License-Identifier: MIT
#include "log/text_dialect.hpp"

#include <algorithm>
#include <limits>
#include <span>

#include "log/guess_rules.hpp"
#include "log/text_header.hpp"
#include "log/text_lines.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"

namespace ripplenotch {
namespace {

constexpr std::size_t lines_compared = 200;  // enough to tell delimiters apart
constexpr std::size_t rows_sampled = 2000;   // evidence for counters and constant columns

bool has_digits(std::string_view text) { return text.find_first_of("0123456789") != std::string_view::npos; }

// Lines at the top that may be names and units: neither is evidence of how numbers are written.
std::size_t lines_put_aside(std::string_view bytes, const std::vector<TextLine>& content) {
    if (content.size() == 1) return 0;
    return content.size() == 2 || has_digits(content[1].of(bytes)) ? 1 : 2;
}

[[noreturn]] void refuse_header_only(const TextLine& header, const std::string& source) {
    raise<DataError>(
        "{}:{}: read only a header, expected rows of numbers under it; check what wrote the file", source,
        header.number);
}

GuessedRules rules_of(std::string_view bytes, const std::vector<TextLine>& content, const std::string& source,
                      const ReadOptions& options) {
    const std::size_t aside = lines_put_aside(bytes, content);
    const auto last = static_cast<std::ptrdiff_t>(std::min(content.size(), lines_compared));
    const GuessedRules rules =
        guess_rules(bytes, content.front(),
                    {content.begin() + static_cast<std::ptrdiff_t>(aside), content.begin() + last}, options);
    if (rules.columns > 0 && rules.numbers > 0) return rules;
    const TextLine& first = content.front();
    if (content.size() <= 2 && has_letters(first.of(bytes)) && !has_digits(content.back().of(bytes)))
        refuse_header_only(first, source);
    raise<DataError>(
        "{}:{}:1: read '{}', expected numbers separated by comma, semicolon, tab or blanks; say how it "
        "is written with --delimiter and --decimal",
        source, content[aside].number, content[aside].of(bytes).substr(0, 40));
}

void take_sample(std::string_view bytes, std::span<const TextLine> rows, TextDialect& dialect) {
    dialect.sample.assign(dialect.columns, {});
    CellSplit split;
    for (std::size_t k = 0; k < rows.size() && k < rows_sampled; ++k) {
        const std::string_view line = rows[k].of(bytes);
        split_cells(line, dialect.rules.delimiter, split);
        if (split.cells.size() != dialect.columns) continue;
        for (std::size_t c = 0; c < dialect.columns; ++c) {
            const auto value = parse_number(split.cells[c].of(line), dialect.rules.decimal_mark);
            dialect.sample[c].push_back(value.value_or(std::numeric_limits<double>::quiet_NaN()));
        }
    }
}

}  // namespace

std::string delimiter_name(char delimiter) {
    if (delimiter == '\t') return "tab";
    if (delimiter == ' ') return "space";
    return std::string(1, delimiter);
}

TextPlace place_of(std::string_view bytes, std::size_t offset, char line_end) {
    TextPlace place;
    for (std::size_t i = 0; i < offset && i < bytes.size(); ++i) {
        if (bytes[i] == line_end) {
            ++place.line;
            place.column = 1;
        } else {
            ++place.column;
        }
    }
    return place;
}

TextDialect sniff_text(std::string_view bytes, bool whole, const std::string& source,
                       const ReadOptions& options) {
    const TextLines lines = opening_lines(bytes, whole, source);
    TextDialect dialect;
    dialect.line_end = lines.line_end;
    const GuessedRules rules = rules_of(bytes, lines.content, source, options);
    dialect.rules = rules.rules;
    dialect.columns = rules.columns;
    const std::size_t row = read_header(bytes, lines, source, options, dialect);
    if (row >= lines.content.size()) refuse_header_only(lines.content.front(), source);
    dialect.data_offset = lines.content[row].begin;
    dialect.data_line = lines.content[row].number;
    take_sample(bytes, std::span(lines.content).subspan(row), dialect);
    return dialect;
}

}  // namespace ripplenotch
