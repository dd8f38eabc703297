// SPDX-License-Identifier: MIT
#include "log/text_dialect.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "log/unit_text.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"

namespace ripplenotch {
namespace {

constexpr std::string_view utf8_mark = "\xef\xbb\xbf";
constexpr std::size_t lines_compared = 200;  // enough to tell delimiters apart
constexpr std::size_t rows_sampled = 2000;   // evidence for counters and constant columns

struct Line {
    std::size_t begin = 0, end = 0;  // content, without line end
    std::size_t next = 0;            // offset of the next line
    std::size_t number = 1;
    [[nodiscard]] std::string_view of(std::string_view bytes) const {
        return bytes.substr(begin, end - begin);
    }
};

void refuse_binary(std::string_view bytes, const std::string& source) {
    if (bytes.empty())
        raise<DataError>("{}: read an empty file, expected rows of numbers; check what wrote it", source);
    const std::string_view two = bytes.substr(0, 2);
    if (two == "\xff\xfe" || two == "\xfe\xff") {
        raise<DataError>(
            "{}:1:1: read UTF-16 text, expected UTF-8; convert it, e.g. with iconv -f UTF-16 -t UTF-8",
            source);
    }
    for (std::size_t i = 0; i < bytes.size(); ++i) {
        const auto byte = static_cast<unsigned char>(bytes[i]);
        if (byte >= 0x20 || byte == '\t' || byte == '\n' || byte == '\r' || byte == '\f') continue;
        const TextPlace place = place_of(bytes, i, '\n');
        raise<DataError>(
            "{}:{}:{}: read the byte 0x{:02x}, expected text; this is not a text log, say which format it "
            "has with --format, or export it as CSV",
            source, place.line, place.column, byte);
    }
}

// Complete lines; the last, unfinished one counts only when the file ends there.
std::vector<Line> lines_of(std::string_view bytes, bool whole, char line_end, std::size_t from) {
    std::vector<Line> lines;
    std::size_t number = 1;
    for (std::size_t begin = from; begin < bytes.size(); ++number) {
        const std::size_t at = bytes.find(line_end, begin);
        if (at == std::string_view::npos && !whole) break;
        Line line{begin, at == std::string_view::npos ? bytes.size() : at, 0, number};
        line.next = at == std::string_view::npos ? bytes.size() : at + 1;
        if (line.end > line.begin && bytes[line.end - 1] == '\r') --line.end;
        lines.push_back(line);
        begin = line.next;
    }
    return lines;
}

bool is_number(std::string_view text, char decimal_mark) {
    return parse_number(text, decimal_mark).has_value();
}

bool has_letters(std::string_view text) {
    return std::any_of(text.begin(), text.end(),
                       [](unsigned char c) { return std::isalpha(c) != 0 || c >= 0x80; });
}

// How well lines read with these rules: rows of equal width, nearly all numbers.
struct Score {
    CellRules rules;
    std::size_t columns = 0;
    double consistent = 0.0;  // share of lines with the commonest number of cells
    double numeric = 0.0;     // share of the cells in them that are numbers or empty
    std::size_t numbers = 0;  // numeric cells in a line, on average, rounded
    [[nodiscard]] double value() const {
        if (columns == 0 || numbers == 0) return 0.0;
        return consistent * numeric * (columns > 1 ? 1.0 : 0.5);
    }
};

Score score(std::string_view bytes, const Line& first, const std::vector<Line>& rows, CellRules rules) {
    Score result{rules};
    std::vector<std::size_t> widths;
    CellSplit split;
    for (const Line& line : rows) {
        split_cells(line.of(bytes), rules.delimiter, split);
        widths.push_back(split.cells.size());
    }
    split_cells(first.of(bytes), rules.delimiter, split);
    const std::size_t names = split.cells.size();
    std::vector<std::size_t> sorted = widths;
    std::sort(sorted.begin(), sorted.end());
    std::size_t best = 0;
    for (std::size_t i = 0; i < sorted.size();) {
        const auto end = std::upper_bound(sorted.begin(), sorted.end(), sorted[i]);
        const auto count = static_cast<std::size_t>(end - sorted.begin()) - i;
        // Between widths that are equally common, the one that the first line has too.
        if (count > best || (count == best && sorted[i] == names)) best = count, result.columns = sorted[i];
        i += count;
    }
    std::size_t cells = 0, good = 0, numbers = 0;
    for (std::size_t k = 0; k < rows.size(); ++k) {
        if (widths[k] != result.columns) continue;
        const std::string_view line = rows[k].of(bytes);
        split_cells(line, rules.delimiter, split);
        for (const Cell& cell : split.cells) {
            const bool number = is_number(cell.of(line), rules.decimal_mark);
            ++cells;
            good += number || cell.begin == cell.end;
            numbers += number;
        }
    }
    if (cells == 0) return result;
    result.consistent = static_cast<double>(best) / static_cast<double>(rows.size());
    result.numeric = static_cast<double>(good) / static_cast<double>(cells);
    result.numbers = (numbers + best - 1) / best;
    return result;
}

Score best_rules(std::string_view bytes, const Line& first, const std::vector<Line>& rows,
                 const ReadOptions& options) {
    // In order of preference between equals. A comma that separates can mark decimals only inside quotes.
    constexpr std::array candidates = {CellRules{'\t', '.'}, CellRules{';', '.'},  CellRules{',', '.'},
                                       CellRules{' ', '.'},  CellRules{'\t', ','}, CellRules{';', ','},
                                       CellRules{' ', ','},  CellRules{',', ','}};
    const bool quotes = bytes.find('"') != std::string_view::npos;
    Score best;
    const auto consider = [&](CellRules rules) {
        const Score now = score(bytes, first, rows, rules);
        // More columns win between readings that are equally good: "1,5;2,5" is two numbers, not one.
        const double margin = now.value() - best.value();
        if (margin > 1e-9 ||
            (margin > -1e-9 && now.columns > best.columns && now.columns > 1 && best.columns <= 1))
            best = now;
    };
    for (CellRules rules : candidates) {
        if (rules.delimiter == ',' && rules.decimal_mark == ',' && !quotes) continue;
        if (options.delimiter && rules.delimiter != *options.delimiter) continue;
        if (options.decimal_mark && rules.decimal_mark != *options.decimal_mark) continue;
        consider(rules);
    }
    if (best.columns == 0 && options.delimiter)
        consider({*options.delimiter, options.decimal_mark.value_or('.')});
    return best;
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

// A row under the header in which every cell is a unit, a dash or nothing, and at least one is a unit.
bool is_unit_row(std::string_view line, const CellSplit& split) {
    bool any = false;
    for (const Cell& cell : split.cells) {
        std::string_view text = cell.of(line);
        while (!text.empty() && (text.front() == '[' || text.front() == '(')) text.remove_prefix(1);
        while (!text.empty() && (text.back() == ']' || text.back() == ')')) text.remove_suffix(1);
        if (text.empty() || text == "-") continue;
        if (std::any_of(text.begin(), text.end(), [](unsigned char c) { return std::isdigit(c) != 0; }))
            return false;
        any = any || usual_unit(text, Role::other) || text == "nm";
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
    for (const Cell& cell : split.cells) texts.push_back(cell_text(line, cell));
    return texts;
}

// Where a column more would be added: before blanks that end a line of cells separated by blanks.
std::size_t content_end(std::string_view bytes, const Line& line, char delimiter) {
    std::size_t end = line.end;
    while (delimiter == ' ' && end > line.begin && (bytes[end - 1] == ' ' || bytes[end - 1] == '\t')) --end;
    return end;
}

void take_sample(std::string_view bytes, const std::vector<Line>& rows, TextDialect& dialect) {
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

// The last comment before the data, when it names as many columns as the data has.
void try_comment_header(std::string_view bytes, const std::vector<Line>& comments, TextDialect& dialect) {
    if (comments.empty()) return;
    const Line& line = comments.back();
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
    refuse_binary(bytes, source);
    const std::size_t start = bytes.substr(0, 3) == utf8_mark ? 3 : 0;
    TextDialect dialect;
    const bool line_feeds = bytes.find('\n') != std::string_view::npos;
    dialect.line_end = !line_feeds && bytes.find('\r') != std::string_view::npos ? '\r' : '\n';

    std::vector<Line> comments, content;
    const std::vector<Line> lines = lines_of(bytes, whole, dialect.line_end, start);
    if (!whole && bytes.size() - (lines.empty() ? start : lines.back().next) > longest_line) {
        raise<DataError>(
            "{}:{}: read a line of more than 1 MiB, expected rows of numbers; check that this is a text log",
            source, lines.size() + 1);
    }
    for (const Line& line : lines) {
        if (is_blank_line(line.of(bytes))) continue;
        if (is_comment_line(line.of(bytes))) {
            if (content.empty()) comments.push_back(line);
        } else {
            content.push_back(line);
        }
    }
    if (content.empty()) {
        raise<DataError>("{}: read {} without a row of numbers, expected rows; check what wrote it", source,
                         whole ? "a file" : "the first 64 kB");
    }
    const std::size_t last = std::min(content.size(), lines_compared);
    // Two lines at the top may be names and units; neither is evidence of how numbers are written.
    const auto has_digits = [&](const Line& line) {
        return line.of(bytes).find_first_of("0123456789") != std::string_view::npos;
    };
    const std::size_t skip = content.size() == 1 ? 0 : content.size() == 2 || has_digits(content[1]) ? 1 : 2;
    const Score rules = best_rules(bytes, content.front(),
                                   {content.begin() + static_cast<std::ptrdiff_t>(skip),
                                    content.begin() + static_cast<std::ptrdiff_t>(last)},
                                   options);
    const Line& first = content.front();
    CellSplit split;
    if (rules.columns == 0 || rules.numbers == 0) {
        if (content.size() <= 2 && has_letters(first.of(bytes)) && !has_digits(content.back())) {
            raise<DataError>(
                "{}:{}: read only a header, expected rows of numbers under it; check what wrote the file",
                source, first.number);
        }
        raise<DataError>(
            "{}:{}:1: read '{}', expected numbers separated by comma, semicolon, tab or blanks; say how it "
            "is written with --delimiter and --decimal",
            source, content[skip].number, content[skip].of(bytes).substr(0, 40));
    }
    dialect.rules = rules.rules;
    dialect.columns = rules.columns;

    std::size_t row = 0;
    split_cells(first.of(bytes), dialect.rules.delimiter, split);
    const FirstLine kind = kind_of(first.of(bytes), split, dialect.rules.decimal_mark);
    const bool wanted = options.header.value_or(kind != FirstLine::numbers);
    if (wanted && kind == FirstLine::mixed && !options.header) {
        // A text column is no reason to doubt: the same column is text in the next row too.
        bool doubtful = false;
        const std::string_view line = first.of(bytes);
        CellSplit below;
        if (content.size() > 1) split_cells(content[1].of(bytes), dialect.rules.delimiter, below);
        for (std::size_t c = 0; c < std::min(split.cells.size(), below.cells.size()); ++c) {
            const std::string_view text = split.cells[c].of(line);
            doubtful =
                doubtful || (has_letters(text) && !is_number(text, dialect.rules.decimal_mark) &&
                             is_number(below.cells[c].of(content[1].of(bytes)), dialect.rules.decimal_mark));
        }
        if (doubtful) {
            raise<DataError>(
                "{}:{}:1: read '{}', half names and half numbers, expected a header or a row; mend the line, "
                "or say --no-header",
                source, first.number, line.substr(0, 60));
        }
    }
    if (wanted && (kind == FirstLine::names || options.header.value_or(false))) {
        dialect.has_header = true;
        dialect.names = texts_of(first.of(bytes), split);
        dialect.quoted_names =
            std::all_of(split.cells.begin(), split.cells.end(), [](const Cell& c) { return c.quoted; });
        dialect.header_end = content_end(bytes, first, dialect.rules.delimiter);
        row = 1;
        if (content.size() > 1) {
            split_cells(content[1].of(bytes), dialect.rules.delimiter, split);
            if (is_unit_row(content[1].of(bytes), split)) {
                for (const std::string& text : texts_of(content[1].of(bytes), split))
                    dialect.units.push_back(bare_unit(text));
                dialect.unit_row_end = content_end(bytes, content[1], dialect.rules.delimiter);
                row = 2;
            }
        }
        // "a,b,c" over "1,2,3,": the writer ends rows with a delimiter.
        if (dialect.names.size() + 1 == dialect.columns) dialect.names.emplace_back();
        if (dialect.names.size() != dialect.columns) {
            raise<DataError>(
                "{}:{}: read {} names over rows of {} cells, expected as many; mend the header, or say "
                "--delimiter, or --no-header with --columns",
                source, first.number, dialect.names.size(), dialect.columns);
        }
        if (!dialect.units.empty()) dialect.units.resize(dialect.columns);
    } else if (!options.header.has_value()) {
        try_comment_header(bytes, comments, dialect);
    }
    if (row >= content.size()) {
        raise<DataError>(
            "{}:{}: read only a header, expected rows of numbers under it; check what wrote the file", source,
            first.number);
    }
    dialect.data_offset = content[row].begin;
    dialect.data_line = content[row].number;
    take_sample(bytes, {content.begin() + static_cast<std::ptrdiff_t>(row), content.end()}, dialect);
    return dialect;
}

}  // namespace ripplenotch
