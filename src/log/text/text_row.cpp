// SPDX-License-Identifier: MIT
#include "log/text/text_row.hpp"

#include <algorithm>

#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/reading.hpp"

namespace ripplenotch {
namespace {

std::vector<WantedColumn> by_column(std::vector<WantedColumn> wanted) {
    std::sort(wanted.begin(), wanted.end(),
              [](const WantedColumn& a, const WantedColumn& b) { return a.column < b.column; });
    return wanted;
}

}  // namespace

TextRow::TextRow(const TextDialect& dialect, std::vector<WantedColumn> wanted, StampRule stamp)
    : rules_(dialect.rules),
      columns_(dialect.columns),
      wanted_(by_column(std::move(wanted))),
      stamp_(stamp),
      parser_(rules_, columns_, wanted_, stamp_) {}

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
    if (split_.cells.size() != columns_) return false;
    row_.values[time_slot] = nothing_yet;
    for (const WantedColumn& wanted : wanted_) {
        const std::string_view text = split_.cells[wanted.column].of(line);
        const bool stamp = stamp_.careful && wanted.slot == time_slot && !wanted.fraction;
        const auto number = stamp ? read_stamp(text, stamp_) : parse_number(text, rules_.decimal_mark);
        if (!number || !is_reading(*number)) return false;
        if (wanted.fraction)
            row_.values[time_slot] += seconds_per_nanosecond * *number;
        else if (wanted.slot == time_slot)
            row_.values[time_slot] += *number;
        else
            row_.values[wanted.slot] = *number;
    }
    return true;
}

}  // namespace ripplenotch
