// SPDX-License-Identifier: MIT
#include "log/text/text_header.hpp"

#include <algorithm>
#include <cctype>

#include "log/columns/unit_text.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"

namespace ripplenotch {
namespace {

bool is_number(std::string_view text, char decimal_mark) {
    return parse_number(text, decimal_mark).has_value();
}

enum class FirstLine { names, numbers, mixed };

FirstLine kind_of(std::string_view line, const CellSplit& split, char decimal_mark) {
    std::size_t words = 0, numbers = 0;
    for (const Cell& cell : split.cells) {
        const std::string_view text = cell.of(line);
        if (text.empty()) continue;
        if (is_number(text, decimal_mark)) {
            ++numbers;
        } else if (has_letters(text)) {
            ++words;
        }
    }
    if (words == 0) return FirstLine::numbers;
    return numbers == 0 ? FirstLine::names : FirstLine::mixed;
}

// Bytes that are no UTF-8 are Latin-1: a degree sign, a micro sign, an umlaut.
std::string as_utf8(const std::string& text) {
    std::string converted;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const auto byte = static_cast<unsigned char>(text[i]);
        const std::size_t more = byte < 0xC2 ? 0 : byte < 0xE0 ? 1 : byte < 0xF0 ? 2 : byte < 0xF5 ? 3 : 0;
        bool whole = byte < 0x80 || more > 0;
        for (std::size_t k = 1; whole && k <= more; ++k)
            whole = i + k < text.size() && (static_cast<unsigned char>(text[i + k]) & 0xC0) == 0x80;
        if (whole) {
            converted += text.substr(i, more + 1);
            i += more;
        } else {
            converted += static_cast<char>(0xC0 | (byte >> 6));
            converted += static_cast<char>(0x80 | (byte & 0x3F));
        }
    }
    return converted;
}

// A row under the header in which every cell is a unit, a dash or nothing, and at least one is a unit.
bool is_unit_row(std::string_view line, const CellSplit& split) {
    bool any = false;
    for (const Cell& cell : split.cells) {
        std::string_view text = cell.of(line);
        while (!text.empty() && (text.front() == '[' || text.front() == '(')) text.remove_prefix(1);
        while (!text.empty() && (text.back() == ']' || text.back() == ')')) text.remove_suffix(1);
        if (text.empty() || text == "-") continue;
        const bool unit = usual_unit(as_utf8(std::string(text)), Role::other) || text == "nm";
        if (!unit &&
            std::any_of(text.begin(), text.end(), [](unsigned char c) { return std::isdigit(c) != 0; }))
            return false;
        any = any || unit;
    }
    return any;
}

std::string bare_unit(std::string text) {
    while (!text.empty() && (text.front() == '[' || text.front() == '(')) text.erase(0, 1);
    while (!text.empty() && (text.back() == ']' || text.back() == ')')) text.pop_back();
    return text == "-" ? "" : text;
}

std::vector<std::string> texts_of(std::string_view line, const CellSplit& split) {
    std::vector<std::string> texts;
    for (const Cell& cell : split.cells) texts.push_back(as_utf8(cell_text(line, cell)));
    return texts;
}

// Where a column more would be added: before blanks that end a line of cells separated by blanks.
std::size_t content_end(std::string_view bytes, const TextLine& line, char delimiter) {
    std::size_t end = line.end;
    while (delimiter == ' ' && end > line.begin && (bytes[end - 1] == ' ' || bytes[end - 1] == '\t')) --end;
    return end;
}

// The last comment before the data, when it names as many columns as the data has.
void try_comment_header(std::string_view bytes, const std::vector<TextLine>& comments, TextDialect& dialect) {
    if (comments.empty()) return;
    const TextLine& line = comments.back();
    std::size_t begin = line.begin;
    while (begin < line.end && std::string_view("#%/ \t").find(bytes[begin]) != std::string_view::npos)
        ++begin;
    const std::string_view text = bytes.substr(begin, line.end - begin);
    CellSplit split;
    split_cells(text, dialect.rules.delimiter, split);
    if (split.cells.size() != dialect.columns ||
        kind_of(text, split, dialect.rules.decimal_mark) != FirstLine::names)
        return;
    // A sentence has as many words as it likes; names are told by a quantity or a unit among them.
    dialect.has_header = dialect.header_in_comment = true;
    dialect.names = texts_of(text, split);
    dialect.header_end = content_end(bytes, line, dialect.rules.delimiter);
}

// Words over numbers in a line that has numbers too. A text column is no reason to doubt: the same column is
// text in the next row as well.
bool is_half_names(std::string_view line, std::string_view below, const CellRules& rules) {
    CellSplit names, numbers;
    split_cells(line, rules.delimiter, names);
    split_cells(below, rules.delimiter, numbers);
    for (std::size_t c = 0; c < std::min(names.cells.size(), numbers.cells.size()); ++c) {
        const std::string_view text = names.cells[c].of(line);
        if (has_letters(text) && !is_number(text, rules.decimal_mark) &&
            is_number(numbers.cells[c].of(below), rules.decimal_mark))
            return true;
    }
    return false;
}

// Returns how many lines the names and their units take.
std::size_t read_names(std::string_view bytes, const TextLines& lines, const std::string& source,
                       TextDialect& dialect) {
    const TextLine& first = lines.content.front();
    CellSplit split;
    split_cells(first.of(bytes), dialect.rules.delimiter, split);
    dialect.has_header = true;
    dialect.names = texts_of(first.of(bytes), split);
    dialect.quoted_names =
        std::all_of(split.cells.begin(), split.cells.end(), [](const Cell& c) { return c.quoted; });
    dialect.header_end = content_end(bytes, first, dialect.rules.delimiter);
    std::size_t taken = 1;
    if (lines.content.size() > 1) {
        const TextLine& second = lines.content[1];
        split_cells(second.of(bytes), dialect.rules.delimiter, split);
        if (is_unit_row(second.of(bytes), split)) {
            for (const std::string& text : texts_of(second.of(bytes), split))
                dialect.units.push_back(bare_unit(text));
            dialect.unit_row_end = content_end(bytes, second, dialect.rules.delimiter);
            taken = 2;
        }
    }
    // "a,b,c" over "1,2,3,": the writer ends rows with a delimiter.
    if (dialect.names.size() + 1 == dialect.columns) dialect.names.emplace_back();
    // LabVIEW: a column of comments that rows without one leave out.
    if (dialect.names.size() == dialect.columns + 1 &&
        (dialect.names.back().empty() || dialect.names.back() == "Comment"))
        dialect.names.pop_back();
    if (dialect.names.size() != dialect.columns) {
        raise<DataError>(
            "{}:{}: read {} names over rows of {} cells, expected as many; mend the header, or say "
            "--delimiter, or --no-header with --columns",
            source, first.number, dialect.names.size(), dialect.columns);
    }
    if (!dialect.units.empty()) dialect.units.resize(dialect.columns);
    return taken;
}

}  // namespace

bool has_letters(std::string_view text) {
    return std::any_of(text.begin(), text.end(),
                       [](unsigned char c) { return std::isalpha(c) != 0 || c >= 0x80; });
}

std::size_t read_header(std::string_view bytes, const TextLines& lines, const std::string& source,
                        const ReadOptions& options, TextDialect& dialect) {
    const TextLine& first = lines.content.front();
    CellSplit split;
    split_cells(first.of(bytes), dialect.rules.delimiter, split);
    const FirstLine kind = kind_of(first.of(bytes), split, dialect.rules.decimal_mark);
    const bool wanted = options.header.value_or(kind != FirstLine::numbers);
    if (wanted && kind == FirstLine::mixed && !options.header && lines.content.size() > 1 &&
        is_half_names(first.of(bytes), lines.content[1].of(bytes), dialect.rules)) {
        raise<DataError>(
            "{}:{}:1: read '{}', half names and half numbers, expected a header or a row; mend the line, "
            "or say --no-header",
            source, first.number, first.of(bytes).substr(0, 60));
    }
    if (wanted && (kind == FirstLine::names || options.header.value_or(false)))
        return read_names(bytes, lines, source, dialect);
    if (!options.header.has_value()) try_comment_header(bytes, lines.comments, dialect);
    return 0;
}

}  // namespace ripplenotch
