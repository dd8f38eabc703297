// SPDX-License-Identifier: MIT
#include "log/text/text_dialect.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <utility>

#include "log/clock/stamp.hpp"
#include "log/columns/column_name.hpp"
#include "log/rows_in_range.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/trace.hpp"

namespace ripplenotch {

namespace {

constexpr std::size_t lines_compared = 200;  // enough to tell delimiters apart
constexpr std::size_t rows_sampled = 2000;   // evidence for counters and constant columns

bool has_digits(std::string_view text) { return text.find_first_of("0123456789") != std::string_view::npos; }

[[noreturn]] void refuse_header_only(const TextLine& header, const std::string& source) {
    raise<DataError>(
        "{}:{}: read only a header, expected rows of numbers under it; check what wrote the file", source,
        header.number);
}

/// How well lines read with these rules: rows of equal width, nearly all numbers.
struct Score {
    CellRules rules;
    std::size_t columns = 0;  ///< the commonest number of cells
    std::size_t numbers = 0;  ///< numeric cells in such a line, on average, rounded up
    double value = 0.0;
};

// Of the lines from `aside` on. Between widths that are equally common, the one that the first line has too.
Score score(const TextLines& lines, std::size_t aside, const CellRules& rules) {
    struct Counts {
        std::size_t lines = 0, good = 0, numbers = 0;  // good: cells that are numbers or empty
    };
    std::map<std::size_t, Counts> widths;
    CellSplit split;
    const std::size_t end = std::min(lines.content.size(), lines_compared);
    for (std::size_t k = aside; k < end; ++k) {
        const std::string_view line = lines.line(k);
        split_cells(line, rules.delimiter, split);
        Counts& counts = widths[split.cells.size()];
        ++counts.lines;
        for (const Cell& cell : split.cells) {
            const bool number = cell_number(cell.of(line), rules.decimal_mark).has_value();
            counts.good += number || cell.begin == cell.end;
            counts.numbers += number;
        }
    }
    split_cells(lines.line(0), rules.delimiter, split);
    Score result{rules};
    Counts best;
    for (const auto& [width, counts] : widths) {
        if (counts.lines > best.lines || (counts.lines == best.lines && width == split.cells.size()))
            best = counts, result.columns = width;
    }
    if (best.numbers == 0) return result;
    result.numbers = (best.numbers + best.lines - 1) / best.lines;
    const double consistent = static_cast<double>(best.lines) / static_cast<double>(end - aside);
    const double numeric = static_cast<double>(best.good) / static_cast<double>(result.columns * best.lines);
    result.value = consistent * numeric * (result.columns > 1 ? 1.0 : 0.5);
    return result;
}

// How the cells are separated and the decimals marked: the reading under which most lines are rows of equally
// many numbers. What `options` state is taken as stated.
Score guess_rules(const TextLines& lines, const ByteSource& source, const ReadOptions& options) {
    // In order of preference between equals. A comma that separates can mark decimals only inside quotes.
    const std::array candidates = {CellRules{'\t', '.'}, CellRules{';', '.'},  CellRules{',', '.'},
                                   CellRules{' ', '.'},  CellRules{'\t', ','}, CellRules{';', ','},
                                   CellRules{' ', ','},  CellRules{',', ','}};
    const bool quotes = lines.bytes.find('"') != std::string_view::npos;
    // Lines at the top that may be names and units: neither is evidence of how numbers are written.
    const std::size_t count = lines.content.size();
    const std::size_t aside = count == 1 ? 0 : count == 2 || has_digits(lines.line(1)) ? 1 : 2;
    Score best;
    const auto consider = [&](const CellRules& rules) {
        const Score now = score(lines, aside, rules);
        // More columns win between readings that are equally good: "1,5;2,5" is two numbers, not one.
        const double margin = now.value - best.value;
        if (margin > 1e-9 ||
            (margin > -1e-9 && now.columns > best.columns && now.columns > 1 && best.columns <= 1))
            best = now;
    };
    for (const CellRules& rules : candidates) {
        if (rules.delimiter == ',' && rules.decimal_mark == ',' && !quotes) continue;
        if (options.delimiter && rules.delimiter != *options.delimiter) continue;
        if (options.decimal_mark && rules.decimal_mark != *options.decimal_mark) continue;
        consider(rules);
    }
    if (best.columns == 0 && options.delimiter) {
        for (const char mark : {'.', ','})
            if (options.decimal_mark.value_or(mark) == mark) consider({*options.delimiter, mark});
    }
    if (best.columns > 0 && best.numbers > 0) return best;
    if (count <= 2 && has_letters(lines.line(0)) && !has_digits(lines.line(count - 1)))
        refuse_header_only(lines.content.front(), source.name());
    raise<DataError>(
        "{}:{}:1: read '{}', expected numbers separated by comma, semicolon, tab or blanks; state how it is "
        "written with --delimiter and --decimal",
        source.name(), number_in_file(source, lines.content[aside].number), lines.line(aside).substr(0, 40));
}

// The first form by which all texts are times and run forward; of several such, that of the shortest time,
// for a date in the wrong order jumps by a month at midnight.
StampForm form_of(const std::vector<std::string_view>& texts) {
    StampForm best;
    double shortest_s = std::numeric_limits<double>::infinity();
    for (const bool milliseconds : {false, true}) {
        for (const bool day_first : {false, true}) {
            const StampForm form{.day_first = day_first, .milliseconds = milliseconds};
            double first_s = 0.0, last_s = -shortest_s;
            bool forward = true;
            for (std::size_t k = 0; k < texts.size() && forward; ++k) {
                const auto time = clock_text(texts[k], form);
                const double now_s = time ? static_cast<double>(time->whole_s) + time->fraction_s : last_s;
                forward = time && (k == 0 || now_s >= last_s);
                if (k == 0) first_s = now_s;
                last_s = now_s;
            }
            if (day_first && forward && last_s - first_s == shortest_s && texts.front().find('/') < 3) {
                best.either_order = true;
                best.other_s = static_cast<std::int64_t>(first_s) - clock_text(texts.front(), best)->whole_s;
            }
            if (!forward || !(last_s - first_s < shortest_s)) continue;
            best = form;
            shortest_s = last_s - first_s;
        }
        if (std::isfinite(shortest_s)) break;
    }
    return best;
}

// What the first cells of a column are: numbers, perhaps with a unit, or dates and times of day.
void look_at_column(std::size_t c, const std::vector<std::string_view>& cells, TextDialect& dialect) {
    const char mark = dialect.rules.decimal_mark;
    const std::string_view first = cells.front();
    bool clocks = !parse_number(first, mark) && clock_text(first), any_number = false;
    const auto of_first = clocks ? std::nullopt : cell_number(first, mark);
    const std::string unit(of_first ? of_first->unit : "");
    if (!clocks) std::from_chars(first.data(), first.data() + first.size(), dialect.first_counts[c]);
    for (const std::string_view cell : cells) {
        const auto plain = parse_number(cell, mark);
        any_number = any_number || plain;
        clocks = clocks && (plain || clock_text(cell));
        const auto number = plain ? CellNumber{*plain, 0, unit} : cell_number(cell, mark);
        dialect.sample[c].push_back(number && number->unit == unit ? number->value : not_a_number);
    }
    dialect.clock_texts[c] = clocks;
    if (!unit.empty()) {
        dialect.rules.units.resize(dialect.columns);
        dialect.rules.units[c] = unit;
        dialect.units.resize(dialect.columns);
        if (dialect.units[c].empty()) dialect.units[c] = unit;
    }
    if (!clocks || any_number) return;
    dialect.stamp_forms[c] = form_of(cells);
    std::ranges::transform(cells, dialect.sample[c].begin(), [&](std::string_view text) {
        const auto time = clock_text(text, dialect.stamp_forms[c]);
        return time ? static_cast<double>(time->whole_s) + time->fraction_s : not_a_number;
    });
}

// Of the lines from the first row on.
void look_at_sample(const TextLines& lines, std::size_t first_row, TextDialect& dialect) {
    dialect.sample.assign(dialect.columns, {});
    dialect.clock_texts.assign(dialect.columns, false);
    dialect.stamp_forms.assign(dialect.columns, {});
    dialect.first_counts.assign(dialect.columns, 0);
    std::vector<std::vector<std::string_view>> cells(dialect.columns);
    CellSplit split;
    for (std::size_t k = first_row; k < std::min(lines.content.size(), first_row + rows_sampled); ++k) {
        split_cells(lines.line(k), dialect.rules.delimiter, split);
        if (split.cells.size() != dialect.columns) continue;
        for (std::size_t c = 0; c < dialect.columns; ++c)
            cells[c].push_back(split.cells[c].of(lines.line(k)));
    }
    for (std::size_t c = 0; c < dialect.columns && !cells[c].empty(); ++c) {
        dialect.has_lists = dialect.has_lists || list_in(cells[c].front());
        look_at_column(c, cells[c], dialect);
    }
}

// "time,A,time,B": the name of the first column over later ones means that each stands in front of its
// signals, as exports write runs that were recorded apart. Only the first keeps it.
void take_repeated_clocks(TextDialect& dialect) {
    std::vector<std::string>& names = dialect.names;
    if (std::ranges::count(names, names.empty() ? "" : names.front()) < 2 ||
        read_column_name(names.front()).role != Role::time)
        return;
    dialect.clock_of.assign(names.size(), 0);
    for (std::size_t c = 1; c < names.size(); ++c) {
        const bool clock = names[c] == names.front();
        dialect.clock_of[c] = clock ? c : dialect.clock_of[c - 1];
        if (clock) names[c].clear();
    }
}

// Whether a signal of a joint has numbers in some rows only, as topics have that were written into one table.
// Where a third of the cells of many rows is empty, they were not lost.
bool has_own_rows(const TextDialect& dialect) {
    constexpr std::size_t many = 64;
    for (std::size_t c = 0; c < std::min(dialect.names.size(), dialect.sample.size()); ++c) {
        const std::vector<double>& numbers = dialect.sample[c];
        const auto empty = static_cast<std::size_t>(
            std::ranges::count_if(numbers, [](double number) { return std::isnan(number); }));
        if (numbers.size() < many || 3 * empty < numbers.size() || empty + 2 > numbers.size()) continue;
        const Role role = read_column_name(dialect.names[c]).role;
        if (role != Role::other && role != Role::time) return true;
    }
    return false;
}

// "LabVIEW Measurement", and below it "Separator" and its name.
std::optional<char> labview_delimiter(const TextLines& lines) {
    if (!lines.line(0).starts_with("LabVIEW Measurement")) return std::nullopt;
    for (std::size_t k = 1; k < lines.content.size(); ++k) {
        if (lines.line(k).starts_with("Separator\tTab")) return '\t';
        if (lines.line(k).starts_with("Separator,Comma")) return ',';
    }
    return std::nullopt;
}

constexpr std::size_t shortest_usual_line = 16, most_usual_lines = 4000;  // for room to begin with
constexpr std::string_view utf8_mark = "\xef\xbb\xbf";

void refuse_binary(std::string_view bytes, const ByteSource& source) {
    if (bytes.empty())
        raise<DataError>("{}: read an empty file, expected rows of numbers; check what wrote it",
                         source.name());
    const std::string_view two = bytes.substr(0, 2);
    if (two == "\xff\xfe" || two == "\xfe\xff") {
        raise<DataError>(
            "{}:1:1: read UTF-16 text, expected UTF-8; convert it, e.g. with iconv -f UTF-16 -t UTF-8",
            source.name());
    }
    const auto* const found = std::ranges::find_if(bytes, is_control);
    if (found == bytes.end()) return;
    const std::string_view before(bytes.begin(), found);
    const auto line = static_cast<std::size_t>(std::ranges::count(before, '\n')) + 1;
    raise<DataError>(
        "{}:{}:{}: read the byte 0x{:02x}, expected text; this is not a text log, state which format it has "
        "with --format, or export it as CSV",
        source.name(), number_in_file(source, line), before.size() - (before.rfind('\n') + 1) + 1,
        static_cast<unsigned char>(*found));
}

// Complete lines; the last, unfinished one counts only when the file ends there.
std::vector<TextLine> lines_of(std::string_view bytes, bool whole, std::size_t from) {
    std::vector<TextLine> lines;
    lines.reserve(std::min(bytes.size() / shortest_usual_line, most_usual_lines));
    std::size_t number = 1;
    for (std::size_t begin = from; begin < bytes.size(); ++number) {
        const std::size_t at = bytes.find('\n', begin);
        if (at == std::string_view::npos && !whole) break;
        TextLine line{begin, std::min(at, bytes.size()), 0, number};
        line.next = std::min(line.end + 1, bytes.size());
        if (line.end > line.begin && bytes[line.end - 1] == '\r') --line.end;
        lines.push_back(line);
        begin = line.next;
    }
    return lines;
}

// No control character, least of all a line's end, and nothing that a number or a name may have.
bool may_separate(char c) { return std::string_view(",;\t |").find(c) != std::string_view::npos; }

// "sep=;" or "sep=\t"
std::optional<char> stated_delimiter(std::string_view line) {
    if (line.size() > 1 && line.front() == '"' && line.back() == '"') line = line.substr(1, line.size() - 2);
    const std::string_view value =
        line.substr(0, 4) == "sep=" || line.substr(0, 4) == "SEP=" ? line.substr(4) : "";
    if (value == "\\t") return '\t';
    return value.size() == 1 && may_separate(value.front()) ? std::optional<char>(value.front())
                                                            : std::nullopt;
}

// The opening of a file, all of it when `whole`; its first `skip_lines` lines count for nothing.
// Throws DataError that begins with the name of `source`: for an empty file, bytes that no text has, UTF-16,
// a line longer than longest_line, nothing but comments.
TextLines opening_lines(std::string_view bytes, bool whole, const ByteSource& source,
                        std::size_t skip_lines) {
    refuse_binary(bytes, source);
    const std::size_t start = bytes.substr(0, 3) == utf8_mark ? 3 : 0;
    TextLines opening{bytes, {}, {}, {}};
    if (bytes.find('\n') == std::string_view::npos && bytes.find('\r') != std::string_view::npos)
        raise<DataError>(
            "{}:1: read lines that end in CR alone, expected LF or CR LF; convert it: tr '\\r' '\\n' < FILE "
            "| ripplenotch ... -",
            source.name());
    std::vector<TextLine> lines = lines_of(bytes, whole, start);
    if (!whole && bytes.size() - (lines.empty() ? start : lines.back().next) > longest_line) {
        raise<DataError>(
            "{}:{}: read a line of more than 1 MiB, expected rows of numbers; check that this is a text log",
            source.name(), number_in_file(source, lines.size() + 1));
    }
    std::size_t kept = 0;
    for (const TextLine& line : lines) {
        if (line.number <= skip_lines || is_blank_line(opening.text(line))) continue;
        if (kept == 0 && !opening.delimiter) {
            opening.delimiter = stated_delimiter(opening.text(line));
            if (opening.delimiter) continue;
        }
        if (!is_comment_line(opening.text(line))) {
            lines[kept++] = line;
        } else if (kept == 0) {
            opening.comments.push_back(line);
        }
    }
    lines.resize(kept);
    opening.content = std::move(lines);
    if (opening.content.empty()) {
        raise<DataError>("{}: read {} without a row of numbers, expected rows; check what wrote it",
                         source.name(), whole ? "a file" : "the first 64 kB");
    }
    return opening;
}

// "--delimiter ';' --decimal ,", as people type it.
std::string options_of(const TextDialect& dialect) {
    const char delimiter = dialect.rules.delimiter;
    const std::string name = delimiter == '\t'  ? "tab"
                             : delimiter == ' ' ? "space"
                             : delimiter == ';' ? "';'"
                                                : std::string(1, delimiter);
    return fmt::format("--delimiter {} --decimal {}{}", name, dialect.rules.decimal_mark,
                       dialect.has_header ? "" : " --no-header");
}

}  // namespace

TextDialect sniff_text(std::string_view bytes, bool whole, const ByteSource& source,
                       const ReadOptions& options) {
    TextLines lines = opening_lines(bytes, whole, source, options.skip_lines);
    const auto drop = [&lines](std::size_t count) {
        lines.content.erase(lines.content.begin(),
                            lines.content.begin() + static_cast<std::ptrdiff_t>(count));
    };
    ReadOptions known = options;
    if (!known.delimiter) known.delimiter = lines.delimiter;
    if (!known.delimiter) known.delimiter = labview_delimiter(lines);
    std::optional<TextDialect> scope;
    if (options.header.value_or(true)) scope = scope_header(lines, source.name());
    TextDialect dialect = scope.value_or(TextDialect());
    drop(static_cast<std::size_t>(std::ranges::count_if(
        lines.content, [&](const TextLine& line) { return line.number <= dialect.head_lines; })));
    if (scope && !known.delimiter) known.delimiter = dialect.rules.delimiter;
    const Score rules = guess_rules(lines, source, known);
    dialect.rules = rules.rules;
    dialect.columns = scope ? dialect.names.size() : rules.columns;
    std::size_t row = 0;
    if (!scope) {
        const std::size_t preamble = find_preamble(lines, dialect);
        if (preamble > 0) dialect.head_lines = lines.content[preamble].number - 1;
        drop(preamble);
        row = read_header(lines, source.name(), options, dialect);
    }
    if (row >= lines.content.size()) refuse_header_only(lines.content.front(), source.name());
    dialect.data_offset = lines.content[row].begin;
    dialect.data_line = lines.content[row].number;
    look_at_sample(lines, row, dialect);
    if (!scope) take_repeated_clocks(dialect);
    const std::set<std::size_t> clocks(dialect.clock_of.begin(), dialect.clock_of.end());
    dialect.own_clocks = clocks.size() > 1 || (has_own_rows(dialect) && !options.hold_bad_values);
    dialect.sums_steps = true;
    dialect.dialect_options = options_of(dialect);
    return dialect;
}

MotionSample text_motion_sample(std::string_view bytes, const TextDialect& dialect, const Layout& layout,
                                const std::vector<std::size_t>& columns) {
    std::vector<WantedColumn> wanted = time_columns(layout);
    for (std::size_t k = 0; k < columns.size(); ++k)
        wanted.push_back({columns[k], slot_of(velocity_slot, k)});
    const RowParser parser(
        {dialect.rules, dialect.columns, wanted, {}, stamp_rule(layout, dialect.rules.decimal_mark)});
    const auto lenient = [](const auto&...) { return std::optional(not_a_number); };
    ParsedRow row(columns.size());
    CellSplit split;
    const bool timed = layout.chosen.time.has_value();
    std::size_t lines = 0;
    double sum = 0.0;
    MotionSample sample{{}, std::vector<std::vector<double>>(columns.size())};
    for (std::size_t begin = 0; begin < bytes.size();) {
        const std::size_t found = bytes.find('\n', begin);
        if (found == std::string_view::npos) break;
        const std::string_view line = line_content(bytes.substr(begin, found - begin));
        begin = found + 1;
        ++lines;
        if (!parser.parse_any(line, row, split, lenient)) continue;
        if (layout.time_is_steps && !sample.time.empty()) sum += row.values[time_slot];
        sample.time.push_back(layout.time_is_steps ? sum
                              : timed              ? row.values[time_slot]
                                                   : static_cast<double>(lines));
        for (std::size_t k = 0; k < columns.size(); ++k)
            sample.values[k].push_back(row.values[slot_of(velocity_slot, k)]);
    }
    return sample;
}

}  // namespace ripplenotch
