// SPDX-License-Identifier: MIT
// Stretch by stretch: find the delimiters, 64 bytes at a time; see how many rows have them where they belong;
// read these rows column by column; let the parser of rows have the few that the vectors are not sure of.
#include "log/quick_rows_avx2.hpp"

#if defined(__x86_64__) && defined(__GNUC__)
#define RIPPLENOTCH_AVX2 1
#include <immintrin.h>
#endif

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>

#include "log/cell_columns_avx2.hpp"
#include "log/row_sink.hpp"

namespace ripplenotch {

#if defined(RIPPLENOTCH_AVX2)
namespace {

constexpr std::size_t first_bytes = 512, stretch_bytes = 8192;
constexpr std::size_t bytes_before = 33;  // of a cell's end that the vectors load

/// The separators of a stretch: offsets of delimiters, line ends and quotes, behind one that stands before
/// its first byte.
struct Edges {
    alignas(64) std::array<std::int32_t, stretch_bytes + 64> place;
    std::size_t count = 0;  ///< without the first
};

__attribute__((target("avx2"))) void find_edges(const char* text, std::size_t size, char delimiter,
                                                char line_end, Edges& found) {
    const __m256i delimiters = _mm256_set1_epi8(delimiter), ends = _mm256_set1_epi8(line_end),
                  quotes = _mm256_set1_epi8('"');
    const auto hits = [&](const char* at) __attribute__((target("avx2"))) {
        const __m256i bytes = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(at));
        const __m256i any = _mm256_or_si256(
            _mm256_cmpeq_epi8(bytes, quotes),
            _mm256_or_si256(_mm256_cmpeq_epi8(bytes, delimiters), _mm256_cmpeq_epi8(bytes, ends)));
        return static_cast<std::uint32_t>(_mm256_movemask_epi8(any));
    };
    found.place[0] = -1;
    std::int32_t* const first = found.place.data() + 1;
    std::int32_t* into = first;
    std::size_t at = 0;
    for (; at + 64 <= size; at += 64) {
        std::uint64_t bits = hits(text + at) | static_cast<std::uint64_t>(hits(text + at + 32)) << 32;
        const int count = std::popcount(bits);
        // Eight places without a branch, most often all there are.
        for (int i = 0; i < 8; ++i, bits &= bits - 1)
            into[i] = static_cast<std::int32_t>(at) + std::countr_zero(bits);
        for (int i = 8; i < count; ++i, bits &= bits - 1)
            into[i] = static_cast<std::int32_t>(at) + std::countr_zero(bits);
        into += count;
    }
    for (; at < size; ++at) {
        if (text[at] == delimiter || text[at] == line_end || text[at] == '"')
            *into++ = static_cast<std::int32_t>(at);
    }
    found.count = static_cast<std::size_t>(into - first);
}

/// How many rows from the first on have each separator where it belongs.
std::size_t regular_rows(const char* text, const Edges& edges, const RowPlan& plan) {
    const std::size_t most = edges.count / plan.columns;
    const std::int32_t* edge = edges.place.data() + 1;
    for (std::size_t row = 0; row < most; ++row) {
        bool regular = text[edge[plan.columns - 1]] == plan.line_end;
        for (std::size_t c = 0; c + 1 < plan.columns; ++c) regular &= text[edge[c]] == plan.rules.delimiter;
        if (!regular) return row;
        edge += plan.columns;
    }
    return most;
}

/// One stretch on its way into a block.
class Stretch {
  public:
    Stretch(RowSink& sink, const RowPlan& plan, const RowParser& parser)
        : sink_(sink), plan_(plan), parser_(parser), parsed_(plan.joints()) {}

    /// Takes the rows of bytes[begin, ...) and returns where it stopped; `begin` itself when it took none.
    std::size_t take(std::string_view bytes, std::size_t begin, double& time_before) {
        begin_ = begin;
        text_ = bytes.data() + begin;
        std::size_t regular = 0;
        // A little at first: where every other row needs care, there is a stretch for each of them.
        for (; regular == 0 && reach_ <= stretch_bytes; reach_ *= 4) {
            find_edges(text_, std::min(reach_, bytes.size() - begin), plan_.rules.delimiter, plan_.line_end,
                       edges_);
            regular = regular_rows(text_, edges_, plan_);
        }
        reach_ = std::min(reach_, stretch_bytes);
        if (regular == 0) return begin;
        sink_.make_room(regular);
        std::fill_n(odd_.begin(), regular, std::uint8_t{0});
        read_columns(regular);
        std::size_t rows = any_odd_ ? mend(regular) : regular;
        if (plan_.column_of(time_slot)) rows = forward_rows(rows, time_before);
        sink_.commit(rows);
        return begin + static_cast<std::size_t>(edge(rows * plan_.columns) + 1);
    }

  private:
    [[nodiscard]] std::int32_t edge(std::size_t number) const { return edges_.place[number]; }
    [[nodiscard]] std::size_t row_begin(std::size_t row) const {
        return static_cast<std::size_t>(edge(row * plan_.columns) + 1);
    }
    [[nodiscard]] std::size_t row_end(std::size_t row) const {
        const auto end = static_cast<std::size_t>(edge((row + 1) * plan_.columns));
        return end > row_begin(row) && text_[end - 1] == '\r' ? end - 1 : end;
    }

    void read_columns(std::size_t rows) {
        any_odd_ = false;
        // What stands before the block must not be looked at.
        std::size_t unread = 0;
        while (unread < rows && begin_ + row_begin(unread) < bytes_before) {
            odd_[unread++] = 1;
            any_odd_ = true;
        }
        for (const WantedColumn& wanted : plan_.wanted) {
            const CellColumn cells{text_,
                                   edges_.place.data() + unread * plan_.columns + wanted.column,
                                   plan_.columns,
                                   rows - unread,
                                   wanted.column + 1 == plan_.columns,
                                   plan_.rules.decimal_mark};
            double* const numbers = sink_.numbers(wanted.slot) + unread;
            if (read_cells_avx2(cells, numbers, odd_.data() + unread)) any_odd_ = true;
        }
        note_places(rows);
    }

    void note_places(std::size_t rows) {
        for (std::size_t row = 0; row < rows; ++row) sink_.place_end(row, begin_ + row_end(row));
        for (std::size_t joint = 0; joint < plan_.joints(); ++joint) {
            const auto torque = plan_.column_of(slot_of(torque_slot, joint));
            const bool last = torque && *torque + 1 == plan_.columns;
            for (std::size_t row = 0; row < rows; ++row) {
                const std::size_t at = row * plan_.columns + torque.value_or(0);
                const auto from = static_cast<std::size_t>(edge(at) + 1);
                const std::size_t to = last     ? row_end(row)
                                       : torque ? static_cast<std::size_t>(edge(at + 1))
                                                : from;
                sink_.place_torque(row, joint, begin_ + from, begin_ + to);
            }
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

    std::size_t forward_rows(std::size_t rows, double& time_before) const {
        const double* const time = sink_.numbers(time_slot);
        for (std::size_t row = 0; row < rows; ++row) {
            if (time[row] < time_before) return row;
            time_before = time[row];
        }
        return rows;
    }

    RowSink& sink_;
    const RowPlan& plan_;
    const RowParser& parser_;
    ParsedRow parsed_;
    const char* text_ = nullptr;
    std::size_t begin_ = 0, reach_ = first_bytes;
    bool any_odd_ = false;
    Edges edges_;
    std::array<std::uint8_t, stretch_bytes + 64> odd_;
};

}  // namespace

std::size_t take_rows_avx2(RowBlock& block, std::size_t begin, double time_before, const RowPlan& plan,
                           const RowParser& parser) {
    const std::string_view bytes = block.bytes;
    RowSink sink(block, begin, plan);
    Stretch stretch(sink, plan, parser);
    while (begin < bytes.size()) {
        const std::size_t from = begin;
        begin = stretch.take(bytes, begin, time_before);
        if (begin == from) break;  // an irregular row, or one longer than the stretch
    }
    return begin;
}

#else

std::size_t take_rows_avx2(RowBlock&, std::size_t begin, double, const RowPlan&, const RowParser&) {
    return begin;
}

#endif

}  // namespace ripplenotch
