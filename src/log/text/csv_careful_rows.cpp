// SPDX-License-Identifier: MIT
// The careful way through a row of a text log, for what the quick ways are not sure of: quoted and empty
// cells, junk, rows that are cut off. It finds the place and the words for what is wrong.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "log/columns/decide_layout.hpp"
#include "log/text/csv_reader.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/reading.hpp"

namespace ripplenotch {
namespace {

std::string shown_cell(std::string_view text) {
    return text.size() <= 40 ? std::string(text) : std::string(text.substr(0, 37)) + "...";
}

}  // namespace

void CsvReader::refuse_controls(std::string_view line) const {
    const auto* const found = std::find_if(line.begin(), line.end(), is_control);
    if (found == line.end()) return;
    complain(static_cast<std::size_t>(found - line.begin()) + 1,
             fmt::format("read the byte 0x{:02x}, expected text; the file is damaged here, remove the line",
                         static_cast<unsigned>(static_cast<unsigned char>(*found))));
}

void CsvReader::parse_carefully(std::string_view line, RowBlock& block, ParsedRow& row) {
    split_cells(line, dialect_.rules.delimiter, split_);
    const auto& cells = split_.cells;
    if (split_.unclosed) {
        complain(cells.back().begin,
                 "read a quote that is not closed on its line, expected its end; mend or remove the line");
    }
    refuse_controls(line);
    if (cells.size() != dialect_.columns) {
        const bool cut = !last_line_complete_ && cells.size() < dialect_.columns;
        complain(cells.empty() ? 1 : cells.back().end + 1,
                 fmt::format("read {} cells, expected {}; {}", cells.size(), dialect_.columns,
                             cut ? "the last line is cut off: remove it, e.g. with head -n -1"
                                 : "mend or remove the line"));
    }
    row.values[time_slot] = nothing_yet;
    for (const WantedColumn& wanted : wanted_) {
        const Cell& cell = cells[wanted.column];
        const double value = read_cell(line, cell, wanted, block);
        if (wanted.fraction)
            row.values[time_slot] += seconds_per_nanosecond * value;
        else if (wanted.slot == time_slot)
            row.values[time_slot] += value;
        else
            row.values[wanted.slot] = value;
        if (is_torque(wanted.slot))
            row.torques[joint_of(wanted.slot)] = {line.data() + cell.begin, line.data() + cell.end};
    }
    const Cell& last = cells.back();
    row.content_end = line.data() + last.end + (last.quoted ? 1 : 0);
}

double CsvReader::read_cell(std::string_view line, const Cell& cell, const WantedColumn& wanted,
                            RowBlock& block) {
    const std::string_view text = cell.of(line);
    const std::size_t slot = wanted.slot;
    const bool stamp = slot == time_slot && stamp_.careful && !wanted.fraction;
    const auto number = stamp ? read_stamp(text, stamp_) : parse_number(text, dialect_.rules.decimal_mark);
    if (number && is_reading(*number)) return *number;
    const std::string name = column_label(dialect_.names, wanted.column);
    // "NA", "null" and the like are texts; only what is empty or a nan of arithmetic counts as a missing
    // value.
    const bool missing = text.empty() || (number && std::isnan(*number));
    if (missing && options_.hold_bad_values && slot != time_slot && rows_ > 0) {
        ++block.held_bad_values;
        return before_.values[slot];
    }
    std::string remedy = "mend or remove the line";
    if (missing && slot != time_slot) {
        remedy = options_.hold_bad_values
                     ? "the first row has no value before it: remove the line"
                     : "mend the line, or say --hold-bad-values to repeat the value before";
    } else if (!number && dialect_.rules.delimiter != ',' &&
               text.find(dialect_.rules.decimal_mark == '.' ? ',' : '.') != std::string_view::npos) {
        remedy =
            fmt::format("mend the line, or say --decimal {}", dialect_.rules.decimal_mark == '.' ? ',' : '.');
    }
    complain(cell.begin + 1,
             fmt::format("read {} in {}, expected a {}; {}",
                         text.empty() ? std::string("nothing") : "'" + shown_cell(text) + "'", name,
                         stamp && stamp_.text               ? "time of day or a date and time"
                         : number && std::isfinite(*number) ? "number from -1e30 to 1e30"
                         : number                           ? "finite number"
                                                            : "number",
                         remedy));
}

void CsvReader::complain(std::size_t column, const std::string& sentence) const {
    raise<DataError>("{}:{}:{}: {}", source_->name(), line_in_file(), column, sentence);
}

}  // namespace ripplenotch
