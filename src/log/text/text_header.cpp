// SPDX-License-Identifier: MIT
#include "log/text/text_header.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>

#include "log/clock/stamp.hpp"
#include "log/columns/decide_layout.hpp"
#include "log/columns/units.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"

namespace ripplenotch {

namespace {

bool is_number(std::string_view text, char decimal_mark) {
    return cell_number(text, decimal_mark).has_value();
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

std::string bare_unit(std::string text) {
    while (!text.empty() && (text.front() == '[' || text.front() == '(')) text.erase(0, 1);
    while (!text.empty() && (text.back() == ']' || text.back() == ')')) text.pop_back();
    return text == "-" ? "" : text;
}

// A row under the header in which every cell is a unit, a dash or nothing, and at least one is a unit.
bool is_unit_row(const std::vector<std::string>& cells) {
    bool any = false;
    for (const std::string& cell : cells) {
        const std::string text = bare_unit(cell);
        if (text.empty()) continue;
        const bool unit = usual_unit(text, Role::other) || text == "nm";
        if (!unit &&
            std::any_of(text.begin(), text.end(), [](unsigned char c) { return std::isdigit(c) != 0; }))
            return false;
        any = any || unit;
    }
    return any;
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
    dialect.names = cell_texts(text, dialect.rules.delimiter);
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
    dialect.names = cell_texts(first.of(bytes), dialect.rules.delimiter);
    dialect.quoted_names =
        std::all_of(split.cells.begin(), split.cells.end(), [](const Cell& c) { return c.quoted; });
    dialect.header_end = content_end(bytes, first, dialect.rules.delimiter);
    std::size_t taken = 1;
    if (lines.content.size() > 1) {
        const TextLine& second = lines.content[1];
        const std::vector<std::string> units = cell_texts(second.of(bytes), dialect.rules.delimiter);
        if (is_unit_row(units)) {
            for (const std::string& unit : units) dialect.units.push_back(bare_unit(unit));
            dialect.unit_row_end = content_end(bytes, second, dialect.rules.delimiter);
            taken = 2;
        }
    }
    // "a,b,c" over "1,2,3,": the writer ends rows with a delimiter.
    if (dialect.names.size() + 1 == dialect.columns) {
        const TextLine& row = lines.content[std::min(taken, lines.content.size() - 1)];
        split_cells(row.of(bytes), dialect.rules.delimiter, split);
        const auto text = [&](std::size_t cell) { return split.cells[cell].of(row.of(bytes)); };
        const std::size_t cells = split.cells.size();
        for (std::size_t c = 0; c + 1 < cells && dialect.rules.delimiter == ','; ++c) {
            if (!clock_text(text(c)) || text(c).find('.') != std::string_view::npos ||
                text(c + 1).size() != 3 || !is_number(text(c + 1), '.'))
                continue;
            raise<DataError>(
                "{}:{}: read the time '{},{}' in two cells, expected one: the comma of its milliseconds "
                "separates cells; write a point, quote the times, or separate cells by ;",
                source, row.number, text(c), text(c + 1));
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

class HeaderLines {
  public:
    HeaderLines(std::string_view bytes, const std::vector<TextLine>& content, const CellRules& rules,
                std::size_t columns)
        : bytes_(bytes), content_(content), rules_(rules), columns_(columns) {}

    [[nodiscard]] std::vector<std::string> cells(std::size_t line) const {
        return cell_texts(content_[line].of(bytes_), rules_.delimiter);
    }

    /// As many cells as a row, numbers in most of them, words in few.
    [[nodiscard]] bool is_row(std::size_t line) const {
        const std::vector<std::string> texts = cells(line);
        const auto numbers = std::count_if(texts.begin(), texts.end(), [this](const std::string& text) {
            return is_number(text, rules_.decimal_mark) || clock_text(text).has_value();
        });
        return texts.size() == columns_ && 2 * static_cast<std::size_t>(numbers) > columns_;
    }

    [[nodiscard]] std::size_t first_row() const {
        std::size_t run = 0;
        for (std::size_t line = 0; line < content_.size(); ++line) {
            run = is_row(line) ? run + 1 : 0;
            if (run == rows_in_a_row || (run > 0 && line + 1 == content_.size())) return line + 1 - run;
        }
        return content_.size();
    }

    /// Words over the columns; a writer may end one of both with a delimiter, LabVIEW adds a comment.
    [[nodiscard]] bool may_be_names(std::size_t line) const {
        const std::vector<std::string> texts = cells(line);
        const auto words = std::count_if(texts.begin(), texts.end(),
                                         [](const std::string& text) { return has_letters(text); });
        const auto numbers = std::count_if(texts.begin(), texts.end(), [this](const std::string& text) {
            return is_number(text, rules_.decimal_mark);
        });
        return texts.size() + 1 >= columns_ && texts.size() <= columns_ + 1 && words > 0 && numbers == 0 &&
               2 * static_cast<std::size_t>(words) >= texts.size();
    }

    [[nodiscard]] bool is_units(std::size_t line) const {
        const std::vector<std::string> texts = cells(line);
        return std::any_of(texts.begin(), texts.end(),
                           [](const std::string& text) { return usual_unit(text, Role::other).has_value(); });
    }

  private:
    std::string_view bytes_;
    const std::vector<TextLine>& content_;
    const CellRules& rules_;
    std::size_t columns_;
};

// LabVIEW: "Delta_X" and a step for each channel, in seconds where "X_Dimension" is Time. Files with
// X_Columns "No" have no other clock.
std::optional<double> read_step(const HeaderLines& lines, std::size_t first_row, char decimal_mark) {
    std::optional<double> step;
    for (std::size_t line = 0; line < first_row; ++line) {
        const std::vector<std::string> cells = lines.cells(line);
        const bool is_step = cells.front() == "Delta_X";
        if (!is_step && cells.front() != "X_Dimension") continue;
        for (std::size_t c = 1; c < cells.size(); ++c) {
            if (cells[c].empty()) continue;
            if (!is_step && cells[c] != "Time") return std::nullopt;
            if (!is_step) continue;
            const auto number = parse_number(cells[c], decimal_mark);
            if (!number || !(*number > 0.0) || *number != step.value_or(*number)) return std::nullopt;
            step = number;
        }
    }
    return step;
}

// LabVIEW: "Y_Unit_Label" and a unit for each channel, behind the column of times.
std::vector<std::string> read_units(const HeaderLines& lines, std::size_t first_row, std::size_t columns) {
    for (std::size_t line = 0; line < first_row; ++line) {
        std::vector<std::string> cells = lines.cells(line);
        if (cells.front() != "Y_Unit_Label") continue;
        cells.front().clear();
        // Without X_Columns no times stand before the channels.
        if (first_row == 0 || lines.cells(first_row - 1).front() != "X_Value") cells.erase(cells.begin());
        cells.resize(columns);
        return cells;
    }
    return {};
}

// The option line that would force a reading, ready to paste: what was decided, in the words the user would
// have used.

// A name that --columns can carry, else the column's number.
std::string handle(const ColumnFacts& facts, std::size_t column) {
    if (facts.names.empty() || facts.names[column].empty()) return std::to_string(column + 1);
    const std::string& name = facts.names[column];
    const bool awkward = name.find_first_of(",=") != std::string::npos ||
                         std::count(facts.names.begin(), facts.names.end(), name) > 1;
    return awkward ? std::to_string(column + 1) : name;
}

std::string quoted(const std::string& word) {
    if (word.find_first_of(" \t;'\"()[]*&|<>$#") == std::string::npos) return word;
    std::string out = "'";
    for (const char c : word) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return out + "'";
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
            "{}:{}:1: read '{}', half names and half numbers, expected a header or a row; correct the line, "
            "or use --no-header",
            source, first.number, first.of(bytes).substr(0, 60));
    }
    if (wanted && (kind == FirstLine::names || options.header.value_or(false)))
        return read_names(bytes, lines, source, dialect);
    if (!options.header.has_value()) try_comment_header(bytes, lines.comments, dialect);
    return 0;
}

Preamble find_preamble(std::string_view bytes, const std::vector<TextLine>& content, const CellRules& rules,
                       std::size_t columns) {
    const HeaderLines lines(bytes, content, rules, columns);
    Preamble found;
    if (lines.cells(0).size() == columns) return found;
    found.first_row = lines.first_row();
    const bool names_then_rows = lines.may_be_names(0) && found.first_row <= 2;
    if (found.first_row == 0 || found.first_row == content.size() || names_then_rows) return {};
    found.row_step_s = read_step(lines, found.first_row, rules.decimal_mark);
    found.units = read_units(lines, found.first_row, columns);
    found.lines = found.first_row;
    const std::size_t above = found.first_row - 1;
    if (above > 0 && lines.is_units(above) && lines.may_be_names(above - 1))
        found.lines = above - 1;
    else if (lines.may_be_names(above))
        found.lines = above;
    return found;
}

std::string options_line(const Layout& layout, const ColumnFacts& facts, const ReadOptions& options) {
    std::vector<std::string> words = {"--format " + layout.format};
    if (!facts.dialect_options.empty()) words.push_back(facts.dialect_options);
    std::vector<std::string> columns, units;
    for (const auto& column :
         {layout.chosen.time, layout.chosen.velocity, layout.chosen.torque, layout.chosen.position}) {
        if (!column) continue;
        const Column& c = layout.columns[*column];
        columns.push_back(fmt::format("{}={}", role_name(c.role), handle(facts, *column)));
        units.push_back(c.scale.empty()
                            ? "--unit " + quoted(fmt::format("{}={}", role_name(c.role), c.unit))
                            : "--scale " + quoted(fmt::format("{}={}", role_name(c.role), c.scale)));
    }
    std::vector<std::string> sides;
    for (const auto& column : {layout.chosen.velocity, layout.chosen.position}) {
        if (column && layout.columns[*column].side == Shaft::motor)
            sides.push_back(fmt::format("{}=motor", role_name(layout.columns[*column].role)));
    }
    if (!columns.empty()) words.push_back("--columns " + quoted(fmt::format("{}", fmt::join(columns, ","))));
    words.insert(words.end(), units.begin(), units.end());
    if (!sides.empty()) words.push_back(fmt::format("--side {}", fmt::join(sides, ",")));
    if (!layout.chosen.joint.empty()) words.push_back("--joint " + quoted(layout.chosen.joint));
    if (layout.stated_rate) words.push_back("--sample-rate " + shortest(layout.stated_rate->value()) + "Hz");
    if (options.constant_speed)
        words.push_back("--constant-speed " + shortest(options.constant_speed->value()) + "deg/s");
    if (options.nm_per_ampere) words.push_back("--kt " + shortest(*options.nm_per_ampere));
    if (options.lead_m) words.push_back("--lead " + shortest(1e3 * *options.lead_m) + "mm");
    if (options.skip_lines > 0) words.push_back(fmt::format("--skip-lines {}", options.skip_lines));
    if (options.hold_bad_values) words.push_back("--hold-bad-values");
    return fmt::format("{}", fmt::join(words, " "));
}

}  // namespace ripplenotch
