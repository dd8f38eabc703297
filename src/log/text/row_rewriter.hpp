// SPDX-License-Identifier: MIT
#pragma once
// Internal to the log room: a block's bytes with other numbers in the places of its torques, or behind its
// rows.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "log/text/printed_cells.hpp"
#include "log/text/row_parser.hpp"
#include "log/text/text_room.hpp"
#include "ripplenotch/log/format.hpp"

namespace ripplenotch {

/// How the rows of a log are written anew.
struct RewritePlan {
    CellRules rules;
    int decimals = 6;                 ///< where they are fixed
    std::vector<std::size_t> joints;  ///< in the order in which their numbers stand in a row
    std::vector<double> factors;      ///< by joint: newton-metres in one unit of its torque column
};

/// Some rows at a time: first all their numbers, then all that stands between.
template <typename Cells>
class RowRewriter {
  public:
    RowRewriter(const RewritePlan& plan, const RowBlock& block, Torques torque_nm, TextRoom& room)
        : plan_(plan), block_(block), room_(room), pieces_(block.bytes) {
        cells_.reserve(plan.joints.size());
        for (const std::size_t j : plan.joints) {
            const JointRows& joint = block.joints[j];
            cells_.emplace_back(plan.rules.decimal_mark, plan.decimals);
            columns_.push_back({&cells_.back(), torque_nm[j].data(), joint.torque_nm.data(),
                                joint.torque_begin.data(), joint.torque_end.data(), plan.factors[j]});
        }
    }

    /// Numbers in the places of the torques.
    void replace() {
        stretch_by_stretch([this](Stretch rows, char* into) { return replace_in(rows, into); });
    }
    /// Numbers in new cells behind the rows.
    void append() {
        stretch_by_stretch([this](Stretch rows, char* into) { return append_to(rows, into); });
    }

  private:
    struct Column {
        Cells* cells;
        const double *torque_nm, *torque_before_nm;
        const std::uint32_t *begin, *end;
        double factor;
    };
    struct Stretch {
        std::size_t first, end;
    };
    static constexpr std::size_t cell_room = number_room + 3;  // with a delimiter and quotes

    template <typename Rewrite>
    void stretch_by_stretch(const Rewrite& rewrite) {
        const std::size_t rows_at_once =
            std::max<std::size_t>(FixedTexts::most / std::max<std::size_t>(columns_.size(), 1), 1);
        for (std::size_t first = 0; first < block_.size(); first += rows_at_once) {
            const Stretch rows = {first, std::min(first + rows_at_once, block_.size())};
            for (Column& column : columns_) {
                const std::span values(column.torque_nm + rows.first, rows.end - rows.first);
                column.cells->prepare({values, column.factor});
            }
            const std::size_t between = block_.row_end[rows.end - 1] - pieces_.done();
            const std::size_t numbers = (rows.end - rows.first) * columns_.size() * cell_room;
            room_.written_until(rewrite(rows, room_.ensure(between + numbers + PieceCopier::over)));
        }
        const std::size_t size = block_.bytes.size();
        char* const into = room_.ensure(size - pieces_.done() + PieceCopier::over);
        room_.written_until(pieces_.copy_until(size, into));
    }

    char* replace_in(Stretch rows, char* into) {
        // What is written could be anything in memory, for all the compiler knows: local copies, for which it
        // does not have to fear.
        PieceCopier pieces = pieces_;
        // Cells whose bad values were replaced do not hold what the block's torque says.
        const bool as_written = block_.held_bad_values == 0;
        const auto replace_one = [&](const Column& column, std::size_t row) {
            if constexpr (Cells::keeps_unchanged)
                if (as_written && column.torque_nm[row] == column.torque_before_nm[row]) return;
            into = pieces.copy_until(column.begin[row], into);
            into = column.cells->put(into, row - rows.first);
            pieces.skip_until(column.end[row]);
        };
        if (columns_.size() == 1) {
            const Column only = columns_.front();
            for (std::size_t row = rows.first; row < rows.end; ++row) replace_one(only, row);
        } else {
            for (std::size_t row = rows.first; row < rows.end; ++row)
                for (const Column& column : columns_) replace_one(column, row);
        }
        pieces_ = pieces;
        return into;
    }

    char* append_to(Stretch rows, char* into) {
        const char delimiter = plan_.rules.delimiter;
        const bool quoted = delimiter == ',' && plan_.rules.decimal_mark == ',';
        for (std::size_t row = rows.first; row < rows.end; ++row) {
            into = pieces_.copy_until(block_.row_end[row], into);
            for (const Column& column : columns_) {
                *into++ = delimiter;
                if (quoted) *into++ = '"';
                into = column.cells->put(into, row - rows.first);
                if (quoted) *into++ = '"';
            }
        }
        return into;
    }

    const RewritePlan& plan_;
    const RowBlock& block_;
    TextRoom& room_;
    PieceCopier pieces_;
    std::vector<Cells> cells_;
    std::vector<Column> columns_;
};

}  // namespace ripplenotch
