// SPDX-License-Identifier: MIT
#pragma once
// Internal to the log room: rows appended to a block, many at a time.

#include <algorithm>
#include <limits>

#include "log/quick_rows.hpp"

namespace ripplenotch {

/// Writes rows behind those that the block has. Call finish() at the end: until then the vectors are longer
/// than the rows.
class RowSink {
  public:
    RowSink(RowBlock& block, std::size_t begin, const RowPlan& plan)
        : block_(block), plan_(plan), rows_(block.size()), room_(block.size()) {
        block.joints.resize(plan.joints());
        // As many rows as the first one's length lets expect, and some.
        const std::size_t left = block.bytes.size() - begin;
        const std::size_t length =
            std::min(block.bytes.find(plan.line_end, begin), block.bytes.size()) - begin;
        reserve(rows_ + left / (length + 1) + left / (16 * (length + 1)) + 16);
    }

    /// Until commit(), numbers() and the places may be used for so many rows.
    void make_room(std::size_t rows) {
        if (rows_ + rows <= room_) return;
        added_ += added_ + rows;
        room_ = rows_ + added_;
        resize(room_);
    }
    /// Of the rows in the making; as in the file.
    [[nodiscard]] double* numbers(std::size_t slot) { return numbers_of(block_, slot).data() + rows_; }
    /// Offsets are from the block's first byte.
    void place_torque(std::size_t row, std::size_t joint, std::size_t begin, std::size_t end) {
        block_.joints[joint].torque_begin[rows_ + row] = static_cast<std::uint32_t>(begin);
        block_.joints[joint].torque_end[rows_ + row] = static_cast<std::uint32_t>(end);
    }
    void place_end(std::size_t row, std::size_t end) {
        block_.row_end[rows_ + row] = static_cast<std::uint32_t>(end);
    }
    /// A whole row, whose line begins at offset `begin` of the block's bytes, which begin at `text`.
    void set(std::size_t row, const ParsedRow& parsed, std::size_t begin, const char* text) {
        for (const WantedColumn& wanted : plan_.wanted)
            numbers(wanted.slot)[row] = parsed.values[wanted.slot];
        const auto offset = [&](const char* at) {
            return at == nullptr ? begin : static_cast<std::size_t>(at - text);
        };
        for (std::size_t joint = 0; joint < parsed.torques.size(); ++joint)
            place_torque(row, joint, offset(parsed.torques[joint].begin), offset(parsed.torques[joint].end));
        place_end(row, offset(parsed.content_end));
    }
    /// Turns the numbers of the first `rows` into the tool's units and keeps them.
    void commit(std::size_t rows) {
        for (std::size_t slot = 0; slot < plan_.factors.size(); ++slot) {
            if (!stored(slot)) continue;
            double* const first = numbers(slot);
            const double factor = plan_.factors[slot];
            if (!plan_.column_of(slot))
                std::fill_n(first, rows, std::numeric_limits<double>::quiet_NaN());
            else if (factor != 1.0)
                std::for_each_n(first, rows, [factor](double& value) { value *= factor; });
        }
        rows_ += rows;
    }

    void finish() { resize(rows_); }

  private:
    /// Positions that the log has not leave their vector empty; other numbers are then not a number.
    [[nodiscard]] bool stored(std::size_t slot) const {
        return !is_position(slot) || plan_.column_of(slot).has_value();
    }
    template <typename Change>
    void all_vectors(const Change& change) {
        for (std::size_t slot = 0; slot < plan_.factors.size(); ++slot)
            if (stored(slot)) change(numbers_of(block_, slot));
        for (JointRows& joint : block_.joints) {
            change(joint.torque_begin);
            change(joint.torque_end);
        }
        change(block_.row_end);
    }
    void reserve(std::size_t size) {
        if (block_.time_s.capacity() < size) all_vectors([size](auto& vector) { vector.reserve(size); });
    }
    void resize(std::size_t size) {
        all_vectors([size](auto& vector) { vector.resize(size); });
    }

    RowBlock& block_;
    const RowPlan& plan_;
    std::size_t rows_, room_, added_ = 0;
};

}  // namespace ripplenotch
