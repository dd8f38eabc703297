// SPDX-License-Identifier: MIT
#include "log/text/text_dialect.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>

#include "log/clock/stamp.hpp"
#include "log/columns/units.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/quantity.hpp"

namespace ripplenotch {

namespace {

bool is_number(std::string_view text, char decimal_mark) {
    return cell_number(text, decimal_mark).has_value();
}

/// How many cells a line has, and what is in them. A date may be a word, too.
struct Kinds {
    std::size_t cells = 0, words = 0, numbers = 0, times = 0;
    [[nodiscard]] bool are_names() const { return words > 0 && numbers == 0; }
};

Kinds kinds_of(std::string_view line, const CellRules& rules) {
    Kinds kinds;
    for (const std::string& text : cell_texts(line, rules.delimiter)) {
        const bool number = is_number(text, rules.decimal_mark);
        ++kinds.cells;
        kinds.numbers += number;
        kinds.words += !number && has_letters(text);
        kinds.times += !number && clock_text(text);
    }
    return kinds;
}

std::string bare_unit(std::string_view text) {
    const std::string_view unit = trimmed(text, "[]()");
    return unit == "-" ? std::string() : std::string(unit);
}

// A row under the header in which every cell is a unit, a dash or nothing, and at least one is a unit.
bool is_unit_row(const std::vector<std::string>& cells) {
    bool any = false;
    for (const std::string& cell : cells) {
        const std::string text = bare_unit(cell);
        if (text.empty()) continue;
        const bool unit = usual_unit(text, Role::other) || text == "nm";
        if (!unit && std::ranges::any_of(text, is_digit)) return false;
        any = any || unit;
    }
    return any;
}

// Where a column more would be added: before blanks that end a line of cells separated by blanks.
std::size_t content_end(const TextLines& lines, const TextLine& line, char delimiter) {
    const std::string_view text = lines.text(line);
    return delimiter == ' ' ? line.begin + text.find_last_not_of(" \t") + 1 : line.end;
}

// The last comment before the data, when it names as many columns as the data has.
void try_comment_header(const TextLines& lines, TextDialect& dialect) {
    if (lines.comments.empty()) return;
    std::string_view text = lines.text(lines.comments.back());
    text.remove_prefix(std::min(text.find_first_not_of("#%/ \t"), text.size()));
    const Kinds kinds = kinds_of(text, dialect.rules);
    // A sentence has as many words as it likes; names are told by a quantity or a unit among them.
    if (kinds.cells != dialect.columns || !kinds.are_names()) return;
    dialect.has_header = true;
    dialect.names = cell_texts(text, dialect.rules.delimiter);
    dialect.header_end = content_end(lines, lines.comments.back(), dialect.rules.delimiter);
}

// Words over numbers in a line that has numbers too. A text column is no reason to doubt: the same column is
// text in the next row as well.
bool is_half_names(const TextLines& lines, const CellRules& rules) {
    const std::vector<std::string> names = lines.cells(0, rules.delimiter),
                                   below = lines.cells(1, rules.delimiter);
    for (std::size_t c = 0; c < std::min(names.size(), below.size()); ++c) {
        if (has_letters(names[c]) && !is_number(names[c], rules.decimal_mark) &&
            is_number(below[c], rules.decimal_mark))
            return true;
    }
    return false;
}

// Returns how many lines the names and their units take.
std::size_t read_names(const TextLines& lines, const std::string& source, TextDialect& dialect) {
    const TextLine& first = lines.content.front();
    const char delimiter = dialect.rules.delimiter;
    CellSplit split;
    split_cells(lines.line(0), delimiter, split);
    dialect.has_header = true;
    dialect.names = lines.cells(0, delimiter);
    dialect.quoted_names = std::ranges::all_of(split.cells, [](const Cell& c) { return c.quoted; });
    dialect.header_end = content_end(lines, first, delimiter);
    std::size_t taken = 1;
    if (lines.content.size() > 1 && is_unit_row(lines.cells(1, delimiter))) {
        dialect.units.clear();
        for (const std::string& unit : lines.cells(1, delimiter)) dialect.units.push_back(bare_unit(unit));
        dialect.unit_row_end = content_end(lines, lines.content[1], delimiter);
        taken = 2;
    }
    // "a,b,c" over "1,2,3,": the writer ends rows with a delimiter.
    if (dialect.names.size() + 1 == dialect.columns) {
        const std::size_t row = std::min(taken, lines.content.size() - 1);
        const std::vector<std::string> cells = lines.cells(row, delimiter);
        for (std::size_t c = 0; c + 1 < cells.size() && delimiter == ','; ++c) {
            if (!clock_text(cells[c]) || cells[c].find('.') != std::string_view::npos ||
                cells[c + 1].size() != 3 || !is_number(cells[c + 1], '.'))
                continue;
            raise<DataError>(
                "{}:{}: read the time '{},{}' in two cells, expected one: the comma of its milliseconds "
                "separates cells; write a point, quote the times, or separate cells by ;",
                source, lines.content[row].number, cells[c], cells[c + 1]);
        }
        dialect.names.emplace_back();
    }
    // LabVIEW: a column of comments that rows without one leave out.
    if (dialect.names.size() == dialect.columns + 1 &&
        (dialect.names.back().empty() || dialect.names.back() == "Comment"))
        dialect.names.pop_back();
    if (dialect.names.size() != dialect.columns) {
        raise<DataError>(
            "{}:{}: read {} names over rows of {} cells, expected as many; correct the header, or use "
            "--delimiter, or --no-header with --columns",
            source, first.number, dialect.names.size(), dialect.columns);
    }
    if (!dialect.units.empty()) dialect.units.resize(dialect.columns);
    return taken;
}

constexpr std::size_t rows_in_a_row = 3;  // so many rows make a table

// As many cells as a row, numbers in most of them, words in few.
bool is_row(std::string_view line, const TextDialect& dialect) {
    const Kinds kinds = kinds_of(line, dialect.rules);
    return kinds.cells == dialect.columns && 2 * (kinds.numbers + kinds.times) > dialect.columns;
}

std::size_t first_row_of(const TextLines& lines, const TextDialect& dialect) {
    std::size_t run = 0;
    for (std::size_t line = 0; line < lines.content.size(); ++line) {
        run = is_row(lines.line(line), dialect) ? run + 1 : 0;
        if (run == rows_in_a_row || (run > 0 && line + 1 == lines.content.size())) return line + 1 - run;
    }
    return lines.content.size();
}

// Words over the columns; a writer may end one of both with a delimiter, LabVIEW adds a comment.
bool may_be_names(std::string_view line, const TextDialect& dialect) {
    const Kinds kinds = kinds_of(line, dialect.rules);
    return kinds.cells + 1 >= dialect.columns && kinds.cells <= dialect.columns + 1 && kinds.are_names() &&
           2 * kinds.words >= kinds.cells;
}

// What LabVIEW says above the rows: "Delta_X" and a step for each channel, in seconds where "X_Dimension" is
// Time, which files with X_Columns "No" have in place of a clock; "Y_Unit_Label" and a unit for each channel,
// behind the column of times.
void read_labview(const TextLines& lines, std::size_t first_row, TextDialect& dialect) {
    bool steps = true;  // alike, and of time
    for (std::size_t line = 0; line < first_row; ++line) {
        std::vector<std::string> cells = lines.cells(line, dialect.rules.delimiter);
        for (std::size_t c = 1; c < cells.size(); ++c) {
            if (cells[c].empty()) continue;
            if (cells[0] == "X_Dimension") steps = steps && cells[c] == "Time";
            if (cells[0] != "Delta_X") continue;
            const double step = parse_number(cells[c], dialect.rules.decimal_mark).value_or(0.0);
            steps = steps && step > 0.0 && step == dialect.row_step_s.value_or(step);
            dialect.row_step_s = step;
        }
        if (cells[0] != "Y_Unit_Label" || !dialect.units.empty()) continue;
        cells[0].clear();
        // Without X_Columns no times stand before the channels.
        if (lines.cells(first_row - 1, dialect.rules.delimiter)[0] != "X_Value") cells.erase(cells.begin());
        cells.resize(dialect.columns);
        dialect.units = cells;
    }
    if (!steps) dialect.row_step_s.reset();
    dialect.row_step_key = "Delta_X";
}

// The head of a TwinCAT Scope export.

constexpr std::string_view name_key = "Name";
constexpr std::size_t most_lines = 60;  // the longest heads have 17 lines for channels and 4 for the project
constexpr double ticks_since_1601 = 1e16;  // no recording has so many milliseconds

// The lines of a head, less "Name".
constexpr std::array<std::string_view, 18> keys = {
    "SymbolComment", "Data-Type",        "SampleTime[ms]", "VariableSize", "SymbolBased",
    "IndexGroup",    "IndexOffset",      "SymbolName",     "NetID",        "NetId",
    "Port",          "Offset",           "ScaleFactor",    "BitMask",      "Unit",
    "Comment",       "Unit ScaleFactor", "Unit Offset"};

std::optional<double> scope_number(std::string_view cell) {
    const auto number = parse_number(cell, '.');
    return number ? number : parse_number(cell, ',');
}

class Head {
  public:
    Head(const TextLines& lines, char delimiter) : lines_(lines), delimiter_(delimiter) {}

    [[nodiscard]] std::vector<std::string> cells(std::size_t line) const {
        return lines_.cells(line, delimiter_);
    }
    [[nodiscard]] bool is_names(std::size_t line) const {
        const std::string_view text = lines_.line(line);
        return text.size() > name_key.size() + 1 && text.starts_with(name_key) &&
               text[name_key.size()] == delimiter_;
    }
    [[nodiscard]] bool is_row(std::size_t line) const {
        const std::vector<std::string> row = cells(line);
        return !row.empty() && scope_number(row.front()).has_value();
    }
    [[nodiscard]] bool is_key(std::size_t line) const {
        const std::vector<std::string> found = cells(line);
        return !found.empty() && std::ranges::find(keys, found.front()) != keys.end();
    }

    /// Finds both; false where there are none, or lines of something else between them: a head that begins
    /// with "Name" by chance.
    bool find_lines() {
        const std::size_t end = std::min(lines_.content.size(), most_lines);
        for (first_row = 1; first_row < end && !is_row(first_row); ++first_row)
            if (is_names(first_row)) names_line = first_row;
        if (first_row >= end) return false;
        for (std::size_t line = names_line + 1; line < first_row; ++line)
            if (!is_key(line)) return false;
        return true;
    }
    std::size_t names_line = 0, first_row = 0;  ///< of the lines of content

    /// What the head says under `key` of each column, as cells; empty where there is no such line.
    [[nodiscard]] std::vector<std::string> under(std::string_view key) const {
        for (std::size_t line = names_line + 1; line < first_row; ++line) {
            std::vector<std::string> found = cells(line);
            if (!found.empty() && found.front() == key) return found;
        }
        return {};
    }

  private:
    const TextLines& lines_;
    char delimiter_;
};

// "Nm (Torque)", "mNm (Torque)", "° (Angle)": the unit, then what it measures.
std::string scope_unit(const std::string& text) {
    const std::size_t bracket = text.ends_with(')') ? text.rfind('(') : std::string::npos;
    std::string unit = text.substr(0, bracket);
    while (unit.ends_with(' ')) unit.pop_back();
    return unit == "None" || unit == "-" ? "" : unit;
}

// A unit's own size says nothing that its name does not say: 0.001 of mNm.
bool is_size_of(double factor, const std::string& unit) {
    for (const Role role : {Role::velocity, Role::torque, Role::position}) {
        const auto usual = usual_unit(unit, role);
        const auto size = usual ? role_factor(role, *usual) : std::nullopt;
        if (!size) continue;
        const double in_si = role == Role::torque ? *size : *size / degrees_per_radian;
        for (const double known : {in_si, 1.0 / in_si})
            if (std::abs(factor / known - 1.0) < 1e-3) return true;
    }
    return false;
}

struct ScaleKey {
    std::string_view key;
    bool factor, of_unit;
};
constexpr std::array scale_keys = {ScaleKey{"ScaleFactor", true, false}, ScaleKey{"Offset", false, false},
                                   ScaleKey{"Unit ScaleFactor", true, true},
                                   ScaleKey{"Unit Offset", false, true}};

void read_scales(const Head& head, std::size_t shift, TextDialect& found) {
    found.scales.assign(found.names.size(), {});
    for (const ScaleKey& key : scale_keys) {
        const std::vector<std::string> cells = head.under(key.key);
        for (std::size_t c = 0; c < found.names.size() && c + shift < cells.size(); ++c) {
            const auto number = scope_number(cells[c + shift]);
            if (!number || *number == (key.factor ? 1.0 : 0.0)) continue;
            if (key.factor && key.of_unit && is_size_of(*number, found.units[c])) continue;
            HeadScale& scale = found.scales[c];
            scale.words += (scale.words.empty() ? "" : ", ") + std::string(key.key) + " " + shortest(*number);
            (key.factor ? scale.factor *= * number : scale.offset += *number);
        }
    }
}

std::optional<double> common_step(const Head& head, const std::string& source) {
    const std::vector<std::string> cells = head.under("SampleTime[ms]");
    std::optional<double> step_ms;
    for (std::size_t c = 1; c < cells.size(); ++c) {
        const auto number = scope_number(cells[c]);
        if (!number || !(*number > 0.0)) continue;
        if (step_ms.value_or(*number) != *number)
            raise<DataError>(
                "{}: read channels of {} and {} ms without times, expected a column of times; export again "
                "with Timelines: All, or channels of one sample time",
                source, shortest(*step_ms), shortest(*number));
        step_ms = number;
    }
    return step_ms ? std::optional<double>(1e-3 * *step_ms) : std::nullopt;
}

// "Name A Name B": a column of times for each channel. "Name A B": times that A and B share.
void read_channels(const std::vector<std::string>& names, const std::vector<std::string>& units,
                   double first_time, TextDialect& found) {
    found.clock_of.assign(names.size(), 0);
    found.names.assign(names.size(), "");
    found.units.assign(names.size(), "");
    for (std::size_t c = 1; c < names.size(); ++c) {
        const bool times = names[c] == name_key;
        found.clock_of[c] = times ? c : found.clock_of[c - 1];
        if (times) continue;
        found.names[c] = names[c];
        if (c < units.size()) found.units[c] = scope_unit(units[c]);
    }
    found.names[0] = first_time > ticks_since_1601 ? "time [100ns]" : "time [ms]";
}

}  // namespace

bool has_letters(std::string_view text) {
    return std::ranges::any_of(text, [](unsigned char c) { return std::isalpha(c) != 0 || c >= 0x80; });
}

std::size_t read_header(const TextLines& lines, const std::string& source, const ReadOptions& options,
                        TextDialect& dialect) {
    const Kinds kinds = kinds_of(lines.line(0), dialect.rules);
    const bool wanted = options.header.value_or(kinds.words > 0);
    if (wanted && kinds.numbers > 0 && !options.header && lines.content.size() > 1 &&
        is_half_names(lines, dialect.rules)) {
        raise<DataError>(
            "{}:{}:1: read '{}', half names and half numbers, expected a header or a row; correct the line, "
            "or use --no-header",
            source, lines.content.front().number, lines.line(0).substr(0, 60));
    }
    if (wanted && (kinds.are_names() || options.header.value_or(false)))
        return read_names(lines, source, dialect);
    if (!options.header.has_value()) try_comment_header(lines, dialect);
    return 0;
}

std::size_t find_preamble(const TextLines& lines, TextDialect& dialect) {
    if (kinds_of(lines.line(0), dialect.rules).cells == dialect.columns) return 0;
    const std::size_t first_row = first_row_of(lines, dialect);
    const bool names_then_rows = may_be_names(lines.line(0), dialect) && first_row <= 2;
    if (first_row == 0 || first_row == lines.content.size() || names_then_rows) return 0;
    read_labview(lines, first_row, dialect);
    const std::size_t above = first_row - 1;
    const std::vector<std::string> units = lines.cells(above, dialect.rules.delimiter);
    const bool are_units = std::ranges::any_of(
        units, [](const auto& text) { return usual_unit(text, Role::other).has_value(); });
    if (above > 0 && are_units && may_be_names(lines.line(above - 1), dialect)) return above - 1;
    return may_be_names(lines.line(above), dialect) ? above : first_row;
}

std::optional<TextDialect> scope_header(const TextLines& lines, const std::string& source) {
    const std::string_view first = lines.line(0);
    constexpr std::string_view separators = "\t;,: ";
    if (!first.starts_with(name_key) || first.size() <= name_key.size() + 1 ||
        separators.find(first[name_key.size()]) == std::string_view::npos)
        return std::nullopt;
    TextDialect found;
    found.rules.delimiter = first[name_key.size()];
    Head head(lines, found.rules.delimiter);
    if (!head.find_lines()) return std::nullopt;
    found.has_header = true;
    found.row_step_key = "SampleTime[ms]";
    found.header_end = lines.content[head.names_line].end;
    found.head_lines = lines.content[head.first_row].number - 1;
    std::vector<std::string> names = head.cells(head.names_line), units = head.under("Unit");
    const std::vector<std::string> row = head.cells(head.first_row);
    const bool twice = std::ranges::count(names, name_key) > 1;
    const bool says_more = head.first_row > head.names_line + 1;
    // A delimiter at the end of the rows alone, or of the head alone.
    if (names.size() + 1 == row.size() && row.back().empty()) names.emplace_back();
    if (names.size() == row.size() + 1 && names.back().empty()) names.pop_back();
    if (says_more && !twice && names.size() == row.size() + 1) {
        found.names.assign(names.begin() + 1, names.end());
        if (!units.empty()) units.erase(units.begin());
        for (std::string& unit : units) unit = scope_unit(unit);
        units.resize(found.names.size());
        found.units = units;
        found.row_step_s = common_step(head, source);
        read_scales(head, 1, found);
        return found;
    }
    const bool names_alone = !says_more && head.names_line == 0 && !twice;
    if (names.size() != row.size()) {
        if (names_alone) return std::nullopt;
        raise<DataError>(
            "{}:{}: read a row of {} cells under {} of a TwinCAT Scope export, expected as many; {}", source,
            lines.content[head.first_row].number, row.size(), names.size(),
            found.rules.delimiter == ','
                ? "a comma that separates cells cannot mark decimals too: export again with another separator"
                : "correct the head, or export again");
    }
    // "Name" alone over names may be a column of names; over times it runs forward.
    const auto first_time = scope_number(row.front());
    if (names_alone) {
        const std::vector<std::string> next =
            head.first_row + 1 < lines.content.size() ? head.cells(head.first_row + 1) : row;
        const auto second_time = scope_number(next.front());
        if (!second_time || !(*second_time > *first_time)) return std::nullopt;
    }
    read_channels(names, units, *first_time, found);
    read_scales(head, 0, found);
    return found;
}

}  // namespace ripplenotch
