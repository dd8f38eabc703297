// SPDX-License-Identifier: MIT
#pragma once
// Internal to the log room: rows appended to a block without a check of capacity for each value.

#include <algorithm>
#include <limits>

#include "log/quick_rows.hpp"

namespace ripplenotch {

/// Writes rows behind those that the block has. Call finish() at the end: until then the vectors are longer
/// than the rows.
class RowSink {
  public:
    RowSink(RowBlock& block, std::size_t begin, const RowPlan& plan)
        : block_(block), factors_(plan.factors), rows_(block.size()), room_(block.size()) {
        for (const WantedColumn& wanted : plan.wanted) present_[wanted.slot] = true;
        // As many rows as the first one's length lets expect, and some.
        const std::size_t left = block.bytes.size() - begin;
        const std::size_t length =
            std::min(block.bytes.find(plan.line_end, begin), block.bytes.size()) - begin;
        reserve(rows_ + left / (length + 1) + left / (16 * (length + 1)) + 16);
    }

    /// Place offsets are from the block's first byte.
    void add(const std::array<double, 4>& values, std::size_t torque_begin, std::size_t torque_end,
             std::size_t row_end) {
        if (rows_ == room_) {
            // Little at first: where every other row is taken otherwise, there is a sink for each of them.
            added_ += added_ + first_rows;
            room_ = rows_ + added_;
            resize(room_);
        }
        constexpr double none = std::numeric_limits<double>::quiet_NaN();
        block_.time_s[rows_] = present_[time_slot] ? values[time_slot] * factors_[time_slot] : none;
        block_.velocity_deg_s[rows_] =
            present_[velocity_slot] ? values[velocity_slot] * factors_[velocity_slot] : none;
        block_.torque_nm[rows_] = present_[torque_slot] ? values[torque_slot] * factors_[torque_slot] : none;
        if (present_[position_slot])
            block_.position_deg[rows_] = values[position_slot] * factors_[position_slot];
        block_.torque_begin[rows_] = static_cast<std::uint32_t>(torque_begin);
        block_.torque_end[rows_] = static_cast<std::uint32_t>(torque_end);
        block_.row_end[rows_] = static_cast<std::uint32_t>(row_end);
        ++rows_;
    }

    void finish() { resize(rows_); }

  private:
    void reserve(std::size_t size) {
        if (block_.time_s.capacity() >= size) return;
        for (auto* values : {&block_.time_s, &block_.velocity_deg_s, &block_.torque_nm})
            values->reserve(size);
        if (present_[position_slot]) block_.position_deg.reserve(size);
        for (auto* places : {&block_.torque_begin, &block_.torque_end, &block_.row_end})
            places->reserve(size);
    }
    void resize(std::size_t size) {
        for (auto* values : {&block_.time_s, &block_.velocity_deg_s, &block_.torque_nm}) values->resize(size);
        block_.position_deg.resize(present_[position_slot] ? size : 0);
        for (auto* places : {&block_.torque_begin, &block_.torque_end, &block_.row_end}) places->resize(size);
    }

    RowBlock& block_;
    std::array<double, 4> factors_;
    std::array<bool, 4> present_{};
    std::size_t rows_, room_, added_ = 0;
    static constexpr std::size_t first_rows = 64;
};

}  // namespace ripplenotch
