// SPDX-License-Identifier: MIT
#include "log/text/text_dialect.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <set>
#include <span>
#include <utility>

#include "log/clock/stamp.hpp"
#include "log/columns/column_name.hpp"
#include "log/rows_in_range.hpp"
#include "log/text/own_clocks.hpp"
#include "log/text/text_header.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/trace.hpp"

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

struct GuessedRules {
    CellRules rules;
    std::size_t columns = 0;  ///< cells in a row; 0 when no reading makes rows of it
    std::size_t numbers = 0;  ///< numeric cells in a row, on average, rounded up
};

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

// The commonest number of cells, and how many lines have it. Between widths that are equally common, the one
// that the first line has too.
std::pair<std::size_t, std::size_t> commonest(std::vector<std::size_t> widths, std::size_t first) {
    std::sort(widths.begin(), widths.end());
    std::size_t width = 0, best = 0;
    for (std::size_t i = 0; i < widths.size();) {
        const auto end = std::upper_bound(widths.begin(), widths.end(), widths[i]);
        const auto count = static_cast<std::size_t>(end - widths.begin()) - i;
        if (count > best || (count == best && widths[i] == first)) best = count, width = widths[i];
        i += count;
    }
    return {width, best};
}

Score score(std::string_view bytes, const TextLine& first, const std::vector<TextLine>& rows,
            CellRules rules) {
    Score result{rules};
    std::vector<std::size_t> widths;
    CellSplit split;
    for (const TextLine& line : rows) {
        split_cells(line.of(bytes), rules.delimiter, split);
        widths.push_back(split.cells.size());
    }
    split_cells(first.of(bytes), rules.delimiter, split);
    const auto [columns, best] = commonest(widths, split.cells.size());
    result.columns = columns;
    std::size_t cells = 0, good = 0, numbers = 0;
    for (std::size_t k = 0; k < rows.size(); ++k) {
        if (widths[k] != result.columns) continue;
        const std::string_view line = rows[k].of(bytes);
        split_cells(line, rules.delimiter, split);
        for (const Cell& cell : split.cells) {
            const bool number = cell_number(cell.of(line), rules.decimal_mark).has_value();
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

// How the cells are separated and the decimals marked: the reading under which most lines are rows of equally
// many numbers. `first` may be a header; `rows` are the lines compared. What `options` state is taken as
// stated.
GuessedRules guess_rules(std::string_view bytes, const TextLine& first, const std::vector<TextLine>& rows,
                         const ReadOptions& options) {
    // In order of preference between equals. A comma that separates can mark decimals only inside quotes.
    const std::array candidates = {CellRules{'\t', '.'}, CellRules{';', '.'},  CellRules{',', '.'},
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
    if (best.columns == 0 && options.delimiter) {
        for (const char mark : {'.', ','})
            if (options.decimal_mark.value_or(mark) == mark) consider({*options.delimiter, mark});
    }
    return {best.rules, best.columns, best.numbers};
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
        "{}:{}:1: read '{}', expected numbers separated by comma, semicolon, tab or blanks; state how it is "
        "written with --delimiter and --decimal",
        source.name(), number_in_file(source, content[aside].number), content[aside].of(bytes).substr(0, 40));
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

void look_at_sample(std::string_view bytes, std::span<const TextLine> rows, TextDialect& dialect) {
    dialect.sample.assign(dialect.columns, {});
    dialect.clock_texts.assign(dialect.columns, false);
    dialect.stamp_forms.assign(dialect.columns, {});
    dialect.first_counts.assign(dialect.columns, 0);
    std::vector<std::vector<std::string_view>> texts(dialect.columns);
    std::vector<std::string> units(dialect.columns);  // behind the numbers of the first row
    CellSplit split;
    for (std::size_t k = 0; k < rows.size() && k < rows_sampled; ++k) {
        const std::string_view line = rows[k].of(bytes);
        split_cells(line, dialect.rules.delimiter, split);
        if (split.cells.size() != dialect.columns) continue;
        for (std::size_t c = 0; c < dialect.columns; ++c) {
            const std::string_view cell = split.cells[c].of(line);
            std::optional<double> value = parse_number(cell, dialect.rules.decimal_mark);
            if (k == 0) dialect.has_lists |= list_in(cell).has_value();
            if (k == 0) std::from_chars(cell.data(), cell.data() + cell.size(), dialect.first_counts[c]);
            if (!value && (k == 0 || dialect.clock_texts[c])) {
                dialect.clock_texts[c] = clock_text(cell).has_value();
                if (dialect.clock_texts[c]) texts[c].push_back(cell);
                if (k == 0 && dialect.clock_texts[c]) dialect.first_counts[c] = 0;
            }
            const auto number = value ? std::nullopt : cell_number(cell, dialect.rules.decimal_mark);
            if (number && k == 0 && !dialect.clock_texts[c]) units[c] = number->unit;
            if (number && number->unit == units[c]) value = number->value;
            dialect.sample[c].push_back(value.value_or(std::numeric_limits<double>::quiet_NaN()));
        }
    }
    for (std::size_t c = 0; c < dialect.columns; ++c) {
        if (units[c].empty()) continue;
        dialect.rules.units.resize(dialect.columns);
        dialect.rules.units[c] = units[c];
        dialect.units.resize(dialect.columns);
        if (dialect.units[c].empty()) dialect.units[c] = units[c];
    }
    for (std::size_t c = 0; c < dialect.columns; ++c) {
        if (!dialect.clock_texts[c] || texts[c].size() != dialect.sample[c].size()) continue;
        dialect.stamp_forms[c] = form_of(texts[c]);
        dialect.sample[c].clear();
        for (const std::string_view text : texts[c]) {
            const auto time = clock_text(text, dialect.stamp_forms[c]);
            dialect.sample[c].push_back(time ? static_cast<double>(time->whole_s) + time->fraction_s
                                             : std::numeric_limits<double>::quiet_NaN());
        }
    }
}

// "time,A,time,B": the name of the first column over later ones means that each stands in front of its
// signals, as exports write runs that were recorded apart. Only the first keeps it.
void take_repeated_clocks(TextDialect& dialect) {
    std::vector<std::string>& names = dialect.names;
    if (std::count(names.begin(), names.end(), names.empty() ? "" : names.front()) < 2 ||
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
            std::count_if(numbers.begin(), numbers.end(), [](double number) { return std::isnan(number); }));
        if (numbers.size() < many || 3 * empty < numbers.size() || empty + 2 > numbers.size()) continue;
        const Role role = read_column_name(dialect.names[c]).role;
        if (role != Role::other && role != Role::time) return true;
    }
    return false;
}

// Only the rows are left in `content`.
void take_scope_header(const ScopeHeader& scope, std::vector<TextLine>& content, ReadOptions& known,
                       TextDialect& dialect) {
    if (!known.delimiter) known.delimiter = scope.delimiter;
    dialect.has_header = true;
    dialect.names = scope.names;
    dialect.units = scope.units;
    dialect.clock_of = scope.clock_of;
    dialect.scales = scope.scales;
    dialect.row_step_s = scope.row_step_s;
    dialect.row_step_key = "SampleTime[ms]";
    dialect.header_end = content[scope.names_line].end;
    dialect.head_lines = content[scope.first_row].number - 1;
    content.erase(content.begin(), content.begin() + static_cast<std::ptrdiff_t>(scope.first_row));
}

// "LabVIEW Measurement", and below it "Separator" and its name.
std::optional<char> labview_delimiter(std::string_view bytes, const std::vector<TextLine>& content) {
    if (!content.front().of(bytes).starts_with("LabVIEW Measurement")) return std::nullopt;
    for (const TextLine& line : content) {
        const std::string_view text = line.of(bytes);
        if (text.starts_with("Separator\tTab")) return '\t';
        if (text.starts_with("Separator,Comma")) return ',';
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
    for (std::size_t i = 0; i < bytes.size(); ++i) {
        if (!is_control(bytes[i])) continue;
        const auto byte = static_cast<unsigned char>(bytes[i]);
        const TextPlace place = place_of(bytes, i);
        raise<DataError>(
            "{}:{}:{}: read the byte 0x{:02x}, expected text; this is not a text log, state which format it "
            "has with --format, or export it as CSV",
            source.name(), number_in_file(source, place.line), place.column, byte);
    }
}

// Complete lines; the last, unfinished one counts only when the file ends there.
std::vector<TextLine> lines_of(std::string_view bytes, bool whole, std::size_t from) {
    std::vector<TextLine> lines;
    lines.reserve(std::min(bytes.size() / shortest_usual_line, most_usual_lines));
    std::size_t number = 1;
    for (std::size_t begin = from; begin < bytes.size(); ++number) {
        const std::size_t at = bytes.find('\n', begin);
        if (at == std::string_view::npos && !whole) break;
        TextLine line{begin, at == std::string_view::npos ? bytes.size() : at, 0, number};
        line.next = at == std::string_view::npos ? bytes.size() : at + 1;
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

std::vector<WantedColumn> by_column(std::vector<WantedColumn> wanted) {
    std::sort(wanted.begin(), wanted.end(),
              [](const WantedColumn& a, const WantedColumn& b) { return a.column < b.column; });
    return wanted;
}

}  // namespace

std::string delimiter_name(char delimiter) {
    if (delimiter == '\t') return "tab";
    if (delimiter == ' ') return "space";
    return std::string(1, delimiter);
}

TextPlace place_of(std::string_view bytes, std::size_t offset) {
    TextPlace place;
    for (std::size_t i = 0; i < offset && i < bytes.size(); ++i) {
        if (bytes[i] == '\n') {
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
    ReadOptions known = options;
    if (!known.delimiter) known.delimiter = lines.delimiter;
    if (!known.delimiter) known.delimiter = labview_delimiter(bytes, lines.content);
    std::optional<ScopeHeader> scope;
    if (options.header.value_or(true)) scope = scope_header(bytes, lines.content, source.name());
    if (scope) take_scope_header(*scope, lines.content, known, dialect);
    const GuessedRules rules = rules_of(bytes, lines.content, source, known);
    dialect.rules = rules.rules;
    dialect.columns = rules.columns;
    std::size_t row = 0;
    if (scope) {
        dialect.columns = dialect.names.size();
    } else {
        const Preamble preamble = find_preamble(bytes, lines.content, dialect.rules, dialect.columns);
        dialect.row_step_s = preamble.row_step_s;
        if (preamble.lines > 0) dialect.head_lines = lines.content[preamble.lines].number - 1;
        lines.content.erase(lines.content.begin(),
                            lines.content.begin() + static_cast<std::ptrdiff_t>(preamble.lines));
        row = read_header(bytes, lines, source.name(), options, dialect);
        if (dialect.units.empty()) dialect.units = preamble.units;
    }
    if (row >= lines.content.size()) refuse_header_only(lines.content.front(), source.name());
    dialect.data_offset = lines.content[row].begin;
    dialect.data_line = lines.content[row].number;
    look_at_sample(bytes, std::span(lines.content).subspan(row), dialect);
    if (!scope) take_repeated_clocks(dialect);
    const std::set<std::size_t> clocks(dialect.clock_of.begin(), dialect.clock_of.end());
    dialect.own_clocks = clocks.size() > 1 || (has_own_rows(dialect) && !options.hold_bad_values);
    return dialect;
}

TextLines opening_lines(std::string_view bytes, bool whole, const ByteSource& source,
                        std::size_t skip_lines) {
    refuse_binary(bytes, source);
    const std::size_t start = bytes.substr(0, 3) == utf8_mark ? 3 : 0;
    TextLines opening;
    if (bytes.find('\n') == std::string_view::npos && bytes.find('\r') != std::string_view::npos)
        raise<DataError>(
            "{}:1: read lines that end in CR alone, expected LF or CR LF; convert it: tr '\\r' '\\n' < FILE "
            "| "
            "ripplenotch ... -",
            source.name());
    std::vector<TextLine> lines = lines_of(bytes, whole, start);
    if (!whole && bytes.size() - (lines.empty() ? start : lines.back().next) > longest_line) {
        raise<DataError>(
            "{}:{}: read a line of more than 1 MiB, expected rows of numbers; check that this is a text log",
            source.name(), number_in_file(source, lines.size() + 1));
    }
    std::size_t kept = 0;
    for (const TextLine& line : lines) {
        if (line.number <= skip_lines || is_blank_line(line.of(bytes))) continue;
        if (kept == 0 && !opening.delimiter) {
            opening.delimiter = stated_delimiter(line.of(bytes));
            if (opening.delimiter) continue;
        }
        if (!is_comment_line(line.of(bytes))) {
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

TextRow::TextRow(const TextDialect& dialect, std::vector<WantedColumn> wanted, StampRule stamp,
                 std::size_t joints, bool lenient)
    : rules_(dialect.rules),
      columns_(dialect.columns),
      parser_(rules_, columns_, by_column(std::move(wanted)), stamp),
      lenient_(lenient),
      row_(joints) {}

bool TextRow::parse(std::string_view line) {
    return parser_.parse(line.data(), line.data() + line.size(), row_) || parse_carefully(line);
}

std::string_view TextRow::cell(std::string_view line, std::size_t column) {
    split_cells(line, rules_.delimiter, split_);
    return split_.cells.size() == columns_ ? split_.cells[column].of(line) : std::string_view();
}

// Quoted cells.
bool TextRow::parse_carefully(std::string_view line) {
    split_cells(line, rules_.delimiter, split_);
    return split_.cells.size() == columns_ && parser_.parse_cells(line, split_, row_, [this](const auto&...) {
        return lenient_ ? std::optional(std::numeric_limits<double>::quiet_NaN()) : std::nullopt;
    });
}

MotionSample text_motion_sample(std::string_view bytes, const TextDialect& dialect, const Layout& layout,
                                const std::vector<MotionPlace>& places) {
    std::vector<WantedColumn> wanted = time_columns(layout);
    for (std::size_t j = 0; j < places.size(); ++j) {
        if (places[j].velocity) wanted.push_back({*places[j].velocity, slot_of(velocity_slot, j)});
        if (places[j].position) wanted.push_back({*places[j].position, slot_of(position_slot, j)});
    }
    TextRow row(dialect, wanted, stamp_rule(layout, dialect.rules.decimal_mark), places.size(), true);
    const bool timed = layout.chosen.time.has_value();
    std::size_t lines = 0;
    double sum = 0.0;
    MotionSample sample{{}, std::vector<MotionSample::Joint>(places.size())};
    for (std::size_t begin = 0; begin < bytes.size();) {
        const std::size_t found = bytes.find('\n', begin);
        if (found == std::string_view::npos) break;
        const std::string_view line = line_content(bytes.substr(begin, found - begin));
        begin = found + 1;
        ++lines;
        if (!row.parse(line)) continue;
        if (layout.time_is_steps && !sample.time.empty()) sum += row.value(time_slot);
        sample.time.push_back(layout.time_is_steps ? sum
                              : timed              ? row.value(time_slot)
                                                   : static_cast<double>(lines));
        for (std::size_t j = 0; j < places.size(); ++j) {
            auto& [velocity, position] = sample.joints[j];
            if (places[j].velocity) velocity.push_back(row.value(slot_of(velocity_slot, j)));
            if (places[j].position) position.push_back(row.value(slot_of(position_slot, j)));
        }
    }
    return sample;
}

}  // namespace ripplenotch
