// SPDX-License-Identifier: MIT
#pragma once
// New logs, written in the tool's own units: what conversion between formats and write_columns share.

#include <algorithm>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "log/text/quick_rows.hpp"
#include "ripplenotch/log/format.hpp"

namespace ripplenotch {

// Internal to the log room: rows appended to a block, many at a time.

/// Writes rows behind those that the block has. They are put together in a place of their own and then
/// appended: making the block's vectors longer first would fill them for nothing.
class RowSink {
  public:
    RowSink(RowBlock& block, std::size_t begin, const RowPlan& plan)
        : block_(block), plan_(plan), numbers_(plan.factors.size()), places_(2 * plan.joints() + 1) {
        block.joints.resize(plan.joints());
        // As many rows as the first one's length lets expect, and some.
        const std::size_t left = block.bytes.size() - begin;
        const std::size_t length = std::min(block.bytes.find('\n', begin), block.bytes.size()) - begin;
        reserve(block.size() + left / (length + 1) + left / (16 * (length + 1)) + 16);
    }

    /// Until commit(), numbers() and the places may be used for so many rows.
    void make_room(std::size_t rows) {
        if (rows <= room_) return;
        room_ = rows;
        for (auto& numbers : numbers_) numbers.resize(rows, std::numeric_limits<double>::quiet_NaN());
        for (auto& places : places_) places.resize(rows);
    }
    /// The numbers of the rows in the making, as in the file.
    [[nodiscard]] double* numbers(std::size_t slot) { return numbers_[slot].data(); }
    /// Offsets from the block's first byte.
    [[nodiscard]] std::uint32_t* torque_begins(std::size_t joint) { return places_[2 * joint].data(); }
    [[nodiscard]] std::uint32_t* torque_ends(std::size_t joint) { return places_[2 * joint + 1].data(); }
    [[nodiscard]] std::uint32_t* row_ends() { return places_.back().data(); }
    /// A whole row, whose line begins at offset `begin` of the block's bytes, which begin at `text`.
    void set(std::size_t row, const ParsedRow& parsed, std::size_t begin, const char* text) {
        for (const WantedColumn& wanted : plan_.wanted)
            numbers(wanted.slot)[row] = parsed.values[wanted.slot];
        const auto offset = [&](const char* at) {
            return static_cast<std::uint32_t>(at == nullptr ? begin : static_cast<std::size_t>(at - text));
        };
        for (std::size_t joint = 0; joint < parsed.torques.size(); ++joint) {
            torque_begins(joint)[row] = offset(parsed.torques[joint].begin);
            torque_ends(joint)[row] = offset(parsed.torques[joint].end);
        }
        row_ends()[row] = offset(parsed.content_end);
    }
    /// Turns the numbers of the first `rows` into the tool's units and appends them.
    void commit(std::size_t rows) {
        for (std::size_t slot = 0; slot < plan_.factors.size(); ++slot) {
            if (!stored(slot)) continue;
            double* const first = numbers(slot);
            const double factor = plan_.factors[slot];
            if (factor != 1.0) std::for_each_n(first, rows, [factor](double& value) { value *= factor; });
            append(numbers_of(block_, slot), numbers_[slot], rows);
        }
        for (std::size_t joint = 0; joint < block_.joints.size(); ++joint) {
            append(block_.joints[joint].torque_begin, places_[2 * joint], rows);
            append(block_.joints[joint].torque_end, places_[2 * joint + 1], rows);
        }
        append(block_.row_end, places_.back(), rows);
    }

  private:
    /// Positions that the log has not leave their vector empty; other numbers are then not a number.
    [[nodiscard]] bool stored(std::size_t slot) const {
        return !is_position(slot) || plan_.column_of(slot).has_value();
    }
    template <typename T>
    static void append(std::vector<T>& to, const std::vector<T>& from, std::size_t rows) {
        to.insert(to.end(), from.begin(), from.begin() + static_cast<std::ptrdiff_t>(rows));
    }
    void reserve(std::size_t size) {
        if (block_.time_s.capacity() >= size) return;
        for (std::size_t slot = 0; slot < plan_.factors.size(); ++slot)
            if (stored(slot)) numbers_of(block_, slot).reserve(size);
        for (JointRows& joint : block_.joints) {
            joint.torque_begin.reserve(size);
            joint.torque_end.reserve(size);
        }
        block_.row_end.reserve(size);
    }

    RowBlock& block_;
    const RowPlan& plan_;
    std::vector<std::vector<double>> numbers_;        ///< by slot
    std::vector<std::vector<std::uint32_t>> places_;  ///< of the torques by joint, then of the rows' ends
    std::size_t room_ = 0;
};

/// Writes a table of numbers a few rows at a time. The sink is the caller's, and so is finishing it.
class TableWriter {
  public:
    virtual ~TableWriter() = default;
    virtual void begin(std::span<const std::string> names) = 0;
    /// One span a column, of equal length.
    virtual void rows(std::span<const std::span<const double>> columns) = 0;
    virtual void end() = 0;
};

using MakeTableWriter = std::unique_ptr<TableWriter> (*)(ByteSink& sink, const WriteOptions& options);

/// The chosen joint's time_s, velocity_deg_s, torque_nm and position_deg as a new log in another format; with
/// options.append the new torque in a column of its own.
[[nodiscard]] std::unique_ptr<LogWriter> convert_rows(std::unique_ptr<ByteSink> sink, const LogReader& reader,
                                                      const WriteOptions& options, MakeTableWriter make);

/// All columns at once. Throws std::invalid_argument when their lengths differ.
void write_table(ByteSink& sink, std::span<const NumberColumn> columns, MakeTableWriter make);

}  // namespace ripplenotch
