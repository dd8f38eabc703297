// SPDX-License-Identifier: MIT
#include "log/text/vector_rows.hpp"

#include <algorithm>
#include <array>
#include <cstdint>

#include "core/vectors/bytes.hpp"
#include "log/row_sink.hpp"
#include "log/text/cell_columns.hpp"
#include "log/text/cell_masks.hpp"
#include "log/text/row_edges.hpp"

namespace ripplenotch {

#if defined(RIPPLENOTCH_BYTE_VECTORS)
namespace {

constexpr std::size_t vector_head_bytes = 512;
constexpr std::size_t bytes_before = 33;  // of a cell's end that the vectors load

/// One stretch on its way into a block.
class Stretch {
  public:
    Stretch(RowSink& sink, const RowPlan& plan, const RowParser& parser)
        : sink_(sink), plan_(plan), parser_(parser), parsed_(plan.joints()) {}

    /// Takes the rows of bytes[begin, ...) and returns where it stopped; `begin` itself when it took none.
    std::size_t read(std::string_view bytes, std::size_t begin, double& time_before) {
        begin_ = begin;
        text_ = bytes.data() + begin;
        std::size_t regular = 0;
        // A little at first: where every other row needs care, there is a stretch for each of them.
        for (; regular == 0 && reach_ <= stretch_bytes; reach_ *= 4) {
            find_edges(text_, std::min(reach_, bytes.size() - begin), separators(), edges_);
            regular = regular_rows(text_, edges_, separators(), plan_.columns);
        }
        reach_ = std::min(reach_, stretch_bytes);
        if (regular == 0) return begin;
        sink_.make_room(regular);
        std::fill_n(odd_.begin(), regular, std::uint8_t{0});
        if (edges_.returns) find_row_ends(regular);
        read_columns(regular);
        note_places(regular);
        std::size_t rows = any_odd_ ? mend(regular) : regular;
        if (plan_.column_of(time_slot)) rows = forward_rows(rows, time_before);
        sink_.commit(rows);
        return begin + static_cast<std::size_t>(edge(rows * plan_.columns) + 1);
    }

  private:
    [[nodiscard]] Separators separators() const { return {plan_.rules.delimiter, plan_.line_end}; }
    [[nodiscard]] std::int32_t edge(std::size_t number) const { return edges_.place[number]; }
    [[nodiscard]] std::size_t row_begin(std::size_t row) const {
        return static_cast<std::size_t>(edge(row * plan_.columns) + 1);
    }
    [[nodiscard]] std::size_t row_end(std::size_t row) const {
        return static_cast<std::size_t>(edges_.returns ? row_ends_[row] : edge((row + 1) * plan_.columns));
    }
    /// Where carriage returns stand before line ends, these are apart from the edges.
    void find_row_ends(std::size_t rows) {
        for (std::size_t row = 0; row < rows; ++row) {
            const std::int32_t end = edge((row + 1) * plan_.columns);
            const bool has_return = end > static_cast<std::int32_t>(row_begin(row)) && text_[end - 1] == '\r';
            row_ends_[row] = end - (has_return ? 1 : 0);
        }
    }

    void read_columns(std::size_t rows) {
        any_odd_ = false;
        // What stands before the block must not be looked at.
        std::size_t unread = 0;
        while (unread < rows && begin_ + row_begin(unread) < bytes_before) {
            odd_[unread++] = 1;
            any_odd_ = true;
        }
        const bool lanes_hold_all =
            longest_cell(edges_.place.data(), rows * plan_.columns) <= static_cast<std::int32_t>(lane_bytes);
        if (plan_.wanted.empty() || plan_.wanted.front().column != 0) doubt_unread_openings(unread, rows);
        for (const WantedColumn& wanted : plan_.wanted) {
            const bool apart = edges_.returns && wanted.column + 1 == plan_.columns;
            const std::int32_t* const before = edges_.place.data() + unread * plan_.columns + wanted.column;
            const CellColumn cells{text_,
                                   before,
                                   apart ? row_ends_.data() + unread : before + 1,
                                   plan_.columns,
                                   apart ? 1 : plan_.columns,
                                   rows - unread,
                                   plan_.rules.decimal_mark,
                                   lanes_hold_all && !apart};
            double* const numbers = sink_.numbers(wanted.slot) + unread;
            if (read_cells(cells, numbers, odd_.data() + unread)) any_odd_ = true;
        }
    }

    /// Comments, blank lines and the end mark have as many cells as they like where the first is not read.
    void doubt_unread_openings(std::size_t from, std::size_t rows) {
        for (std::size_t row = from; row < rows; ++row) {
            const char first = text_[row_begin(row)];
            const bool sure = static_cast<unsigned char>(first - '0') < 10 || first == '-';
            odd_[row] |= sure ? 0 : 1;
            any_odd_ |= !sure;
        }
    }

    void note_places(std::size_t rows) {
        const auto shift = static_cast<std::uint32_t>(begin_);
        std::uint32_t* const ends = sink_.row_ends();
        for (std::size_t row = 0; row < rows; ++row)
            ends[row] = shift + static_cast<std::uint32_t>(row_end(row));
        for (std::size_t joint = 0; joint < plan_.joints(); ++joint) {
            const auto torque = plan_.column_of(slot_of(torque_slot, joint));
            const std::int32_t* before = edges_.place.data() + torque.value_or(0);
            const bool last = torque && *torque + 1 == plan_.columns;
            std::uint32_t *const from = sink_.torque_begins(joint), *const to = sink_.torque_ends(joint);
            for (std::size_t row = 0; row < rows; ++row, before += plan_.columns) {
                from[row] = shift + static_cast<std::uint32_t>(before[0] + 1);
                if (!last) to[row] = torque ? shift + static_cast<std::uint32_t>(before[1]) : from[row];
            }
            if (last) std::copy_n(ends, rows, to);
        }
    }

    /// Reads the odd rows again, the slow way; returns how many rows there are before the first that is not
    /// certainly right.
    std::size_t mend(std::size_t rows) {
        for (std::size_t row = 0; row < rows; ++row) {
            if (odd_[row] == 0) continue;
            if (!parser_.parse(text_ + row_begin(row), text_ + row_end(row), parsed_)) return row;
            sink_.set(row, parsed_, begin_ + row_begin(row), text_ - begin_);
        }
        return rows;
    }

    /// How many rows there are before one whose time is before the one above it.
    std::size_t forward_rows(std::size_t rows, double& time_before) const {
        const double* const time = sink_.numbers(time_slot);
        if (rows == 0 || time[0] < time_before) return 0;
        std::size_t row = 1;
        while (row < rows && !(time[row] < time[row - 1])) ++row;
        time_before = time[row - 1];
        return row;
    }

    RowSink& sink_;
    const RowPlan& plan_;
    const RowParser& parser_;
    ParsedRow parsed_;
    const char* text_ = nullptr;
    std::size_t begin_ = 0, reach_ = vector_head_bytes;
    bool any_odd_ = false;
    Edges edges_;
    std::array<std::int32_t, stretch_bytes> row_ends_;  ///< offsets from text_
    std::array<std::uint8_t, stretch_bytes> odd_;
};

}  // namespace

std::size_t read_rows_by_vectors(RowBlock& block, std::size_t begin, double time_before, const RowPlan& plan,
                                 const RowParser& parser) {
    const std::string_view bytes = block.bytes;
    RowSink sink(block, begin, plan);
    Stretch stretch(sink, plan, parser);
    while (begin < bytes.size()) {
        const std::size_t from = begin;
        begin = stretch.read(bytes, begin, time_before);
        if (begin == from) break;  // an irregular row, or one longer than the stretch
    }
    return begin;
}

#else

std::size_t read_rows_by_vectors(RowBlock&, std::size_t begin, double, const RowPlan&, const RowParser&) {
    return begin;
}

#endif

}  // namespace ripplenotch
