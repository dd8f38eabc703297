// SPDX-License-Identifier: MIT
#pragma once
// Internal to the log room: a column of cells read in groups of rows, and what groups cannot take one by one.

#include "log/cell_columns.hpp"

namespace ripplenotch {

/// Most columns have the decimal mark in the same place, counted from the end, all the way down. A Group
/// reads so many `rows` at a time as long as it is there, with
///   std::size_t read(column, row, numbers): from `row` on; returns where the marks are elsewhere, or where
///   it
///     is not sure. Mantissas below 2^52 and powers of ten up to 1e15 are exact doubles, so that one division
///     rounds correctly (W. D. Clinger, How to read floating point numbers accurately, 1990);
///   bool find_places(column, row): for the marks of the rows there; false where it could not read them:
///   junk,
///     more than one mark, long numbers, or nothing behind a mark, which could stand alone in the next cell.
template <typename Group>
bool read_groups(Group& group, const CellColumn& column, double* numbers, std::uint8_t* odd) {
    bool any_odd = false;
    std::size_t row = 0;
    while (row < column.rows) {
        row = group.read(column, row, numbers);
        if (row + Group::rows <= column.rows && group.find_places(column, row)) continue;
        // Numbers that are too long for groups seldom come alone.
        CellCursor at(column, row);
        for (std::size_t alone = 0; row < column.rows && (alone < Group::rows || at.length() > 16); ++alone) {
            if (!read_long_cell(at, column.decimal_mark, numbers[row])) {
                odd[row] = 1;
                any_odd = true;
            }
            ++row;
            at.advance(1);
        }
    }
    return any_odd;
}

}  // namespace ripplenotch
