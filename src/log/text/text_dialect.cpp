// SPDX-License-Identifier: MIT
#include "log/text/text_dialect.hpp"

#include <algorithm>
#include <charconv>
#include <limits>
#include <span>

#include "log/clock/stamp.hpp"
#include "log/columns/guess_rules.hpp"
#include "log/text/text_header.hpp"
#include "log/text/text_lines.hpp"
#include "log/text/text_preamble.hpp"
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

GuessedRules rules_of(std::string_view bytes, const std::vector<TextLine>& content, const ByteSource& source,
                      const ReadOptions& options) {
    const std::size_t aside = lines_put_aside(bytes, content);
    const auto last = static_cast<std::ptrdiff_t>(std::min(content.size(), lines_compared));
    const GuessedRules rules =
        guess_rules(bytes, content.front(),
                    {content.begin() + static_cast<std::ptrdiff_t>(aside), content.begin() + last}, options);
    if (rules.columns > 0 && rules.numbers > 0) return rules;
    const TextLine& first = content.front();
    if (content.size() <= 2 && has_letters(first.of(bytes)) && !has_digits(content.back().of(bytes)))
        refuse_header_only(first, source.name());
    raise<DataError>(
        "{}:{}:1: read '{}', expected numbers separated by comma, semicolon, tab or blanks; say how it "
        "is written with --delimiter and --decimal",
        source.name(), source.number_in_file(content[aside].number), content[aside].of(bytes).substr(0, 40));
}

void look_at_sample(std::string_view bytes, std::span<const TextLine> rows, TextDialect& dialect) {
    dialect.sample.assign(dialect.columns, {});
    dialect.clock_texts.assign(dialect.columns, false);
    dialect.first_counts.assign(dialect.columns, 0);
    CellSplit split;
    for (std::size_t k = 0; k < rows.size() && k < rows_sampled; ++k) {
        const std::string_view line = rows[k].of(bytes);
        split_cells(line, dialect.rules.delimiter, split);
        if (split.cells.size() != dialect.columns) continue;
        for (std::size_t c = 0; c < dialect.columns; ++c) {
            const std::string_view cell = split.cells[c].of(line);
            auto value = parse_number(cell, dialect.rules.decimal_mark);
            if (k == 0) std::from_chars(cell.data(), cell.data() + cell.size(), dialect.first_counts[c]);
            if (!value && (k == 0 || dialect.clock_texts[c])) {
                if (const auto time = clock_text(cell))
                    value = static_cast<double>(time->whole_s) + time->fraction_s;
                dialect.clock_texts[c] = value.has_value();
                if (k == 0 && value) dialect.first_counts[c] = 0;
            }
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

TextDialect sniff_text(std::string_view bytes, bool whole, const ByteSource& source,
                       const ReadOptions& options) {
    TextLines lines = opening_lines(bytes, whole, source, options.skip_lines);
    TextDialect dialect;
    dialect.line_end = lines.line_end;
    ReadOptions known = options;
    if (!known.delimiter) known.delimiter = lines.delimiter;
    const GuessedRules rules = rules_of(bytes, lines.content, source, known);
    dialect.rules = rules.rules;
    dialect.columns = rules.columns;
    const Preamble preamble = find_preamble(bytes, lines.content, dialect.rules, dialect.columns);
    dialect.row_step_s = preamble.row_step_s;
    std::size_t row = preamble.first_row;
    if (preamble.lines > 0) dialect.head_lines = lines.content[preamble.lines].number - 1;
    if (preamble.names.empty()) {
        lines.content.erase(lines.content.begin(),
                            lines.content.begin() + static_cast<std::ptrdiff_t>(preamble.lines));
        row = read_header(bytes, lines, source.name(), options, dialect);
    } else {
        dialect.has_header = true;
        dialect.names = preamble.names;
        dialect.units = preamble.units;
        dialect.clock_of = preamble.clock_of;
        dialect.header_end = lines.content[preamble.names_line].end;
    }
    if (row >= lines.content.size()) refuse_header_only(lines.content.front(), source.name());
    dialect.data_offset = lines.content[row].begin;
    dialect.data_line = lines.content[row].number;
    look_at_sample(bytes, std::span(lines.content).subspan(row), dialect);
    return dialect;
}

}  // namespace ripplenotch
