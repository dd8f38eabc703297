// SPDX-License-Identifier: MIT
#include "log/text/text_preamble.hpp"

#include <algorithm>

#include "log/clock/stamp.hpp"
#include "log/columns/unit_text.hpp"
#include "log/text/text_header.hpp"
#include "ripplenotch/core/number.hpp"

namespace ripplenotch {
namespace {

constexpr std::size_t rows_in_a_row = 3;  // so many rows make a table

class Lines {
  public:
    Lines(std::string_view bytes, const std::vector<TextLine>& content, const CellRules& rules,
          std::size_t columns)
        : bytes_(bytes), content_(content), rules_(rules), columns_(columns) {}

    [[nodiscard]] std::vector<std::string> cells(std::size_t line) const {
        const std::string_view text = content_[line].of(bytes_);
        CellSplit split;
        split_cells(text, rules_.delimiter, split);
        std::vector<std::string> cells;
        for (const Cell& cell : split.cells) cells.push_back(cell_text(text, cell));
        return cells;
    }

    /// As many cells as a row, numbers in most of them, words in few.
    [[nodiscard]] bool is_row(std::size_t line) const {
        const std::vector<std::string> texts = cells(line);
        const auto numbers = std::count_if(texts.begin(), texts.end(), [this](const std::string& text) {
            return parse_number(text, rules_.decimal_mark).has_value() || clock_text(text).has_value();
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
            return parse_number(text, rules_.decimal_mark).has_value();
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

/// "Name A Name B" over pairs of time and value, "Name A B" where two channels share their times.
bool speaks_of_channels(const std::vector<std::string>& cells, std::string_view key, std::size_t columns) {
    return columns > 1 && cells.size() >= columns && cells[0] == key && cells[1] != key;
}

// TwinCAT Scope: a line of "Name", channel, "Name", channel, ...; "Name" stands over a column of times, which
// channels of one rate may share. Times are milliseconds since the start, or FILETIME.
void read_channels(const Lines& lines, std::size_t columns, Preamble& found) {
    for (std::size_t line = 0; line < found.first_row; ++line) {
        const std::vector<std::string> cells = lines.cells(line);
        if (speaks_of_channels(cells, "Name", columns)) {
            const auto first = parse_number(lines.cells(found.first_row).front());
            found.names.assign(columns, "");
            found.clock_of.assign(columns, 0);
            for (std::size_t c = 1; c < columns; ++c) {
                const bool times = cells[c] == "Name";
                found.clock_of[c] = times ? c : found.clock_of[c - 1];
                if (!times) found.names[c] = cells[c];
            }
            found.names[0] = first && *first > 1e16 ? "time [100ns]" : "time [ms]";
            found.names_line = line;
        }
        if (!found.names.empty() && speaks_of_channels(cells, "Unit", columns)) {
            found.units.assign(columns, "");
            for (std::size_t c = 1; c < columns; ++c) {
                if (found.clock_of[c] != c && usual_unit(cells[c], Role::other)) found.units[c] = cells[c];
            }
        }
    }
}

// LabVIEW: "Delta_X" and a step for each channel, in seconds where "X_Dimension" is Time. Files with
// X_Columns "No" have no other clock.
std::optional<double> read_step(const Lines& lines, std::size_t first_row, char decimal_mark) {
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

}  // namespace

Preamble find_preamble(std::string_view bytes, const std::vector<TextLine>& content, const CellRules& rules,
                       std::size_t columns) {
    const Lines lines(bytes, content, rules, columns);
    Preamble found;
    if (lines.cells(0).size() == columns) return found;
    found.first_row = lines.first_row();
    const bool names_then_rows = lines.may_be_names(0) && found.first_row <= 2;
    if (found.first_row == 0 || found.first_row == content.size() || names_then_rows) return {};
    read_channels(lines, columns, found);
    found.row_step_s = read_step(lines, found.first_row, rules.decimal_mark);
    found.lines = found.first_row;
    if (!found.names.empty()) return found;
    const std::size_t above = found.first_row - 1;
    if (above > 0 && lines.is_units(above) && lines.may_be_names(above - 1))
        found.lines = above - 1;
    else if (lines.may_be_names(above))
        found.lines = above;
    return found;
}

}  // namespace ripplenotch
