// SPDX-License-Identifier: MIT
// Stretch by stretch: find the delimiters, 64 bytes at a time; see how many rows have them where they belong;
// read these rows column by column; let the parser of rows have the few that the vectors are not sure of.
#include "log/quick_rows_avx2.hpp"

#if defined(__x86_64__) && defined(__GNUC__)
#define RIPPLENOTCH_AVX2 1
#define WITH_AVX2 __attribute__((target("avx2")))
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
    std::size_t line_ends = 0;
    bool quotes = false, returns = false;  ///< there are some: quotes, carriage returns that end no line
};

/// One bit for each of 64 bytes.
struct EdgeBits {
    std::uint64_t any, line_ends;
};

class EdgeFinder {
  public:
    WITH_AVX2 EdgeFinder(char delimiter, char line_end)
        : delimiters_(_mm256_set1_epi8(delimiter)), line_ends_(_mm256_set1_epi8(line_end)) {}

    WITH_AVX2 EdgeBits look_at(const char* text) {
        const EdgeBits low = look_at_half(text), high = look_at_half(text + 32);
        return {low.any | high.any << 32, low.line_ends | high.line_ends << 32};
    }
    WITH_AVX2 [[nodiscard]] bool quotes() const { return _mm256_testz_si256(quotes_, quotes_) == 0; }
    WITH_AVX2 [[nodiscard]] bool returns() const { return _mm256_testz_si256(returns_, returns_) == 0; }

  private:
    WITH_AVX2 EdgeBits look_at_half(const char* text) {
        const __m256i bytes = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(text));
        const __m256i quote = _mm256_cmpeq_epi8(bytes, _mm256_set1_epi8('"'));
        const __m256i line_end = _mm256_cmpeq_epi8(bytes, line_ends_);
        const __m256i delimiter = _mm256_cmpeq_epi8(bytes, delimiters_);
        quotes_ = _mm256_or_si256(quotes_, quote);
        returns_ = _mm256_or_si256(returns_, _mm256_cmpeq_epi8(bytes, _mm256_set1_epi8('\r')));
        const auto bits = [](__m256i mask)
                              WITH_AVX2 { return static_cast<std::uint32_t>(_mm256_movemask_epi8(mask)); };
        return {bits(_mm256_or_si256(quote, _mm256_or_si256(delimiter, line_end))), bits(line_end)};
    }

    __m256i delimiters_, line_ends_, quotes_ = _mm256_setzero_si256(), returns_ = _mm256_setzero_si256();
};

WITH_AVX2 void find_edges(const char* text, std::size_t size, char delimiter, char line_end, Edges& found) {
    EdgeFinder finder(delimiter, line_end);
    found.place[0] = -1;
    std::int32_t* const first = found.place.data() + 1;
    std::int32_t* into = first;
    std::size_t at = 0;
    int line_ends = 0;
    for (; at + 64 <= size; at += 64) {
        auto [bits, ends] = finder.look_at(text + at);
        line_ends += std::popcount(ends);
        const int count = std::popcount(bits);
        // Eight places without a branch, most often all there are.
        for (int i = 0; i < 8; ++i, bits &= bits - 1)
            into[i] = static_cast<std::int32_t>(at) + std::countr_zero(bits);
        for (int i = 8; i < count; ++i, bits &= bits - 1)
            into[i] = static_cast<std::int32_t>(at) + std::countr_zero(bits);
        into += count;
    }
    found.quotes = finder.quotes();
    found.returns = finder.returns();
    for (; at < size; ++at) {
        if (text[at] == delimiter || text[at] == line_end || text[at] == '"')
            *into++ = static_cast<std::int32_t>(at);
        line_ends += text[at] == line_end ? 1 : 0;
        found.quotes |= text[at] == '"';
        found.returns |= text[at] == '\r';
    }
    found.returns &= line_end != '\r';
    found.count = static_cast<std::size_t>(into - first);
    found.line_ends = static_cast<std::size_t>(line_ends);
}

/// How many rows from the first on end where they should.
std::size_t ended_rows(const char* text, const Edges& edges, const RowPlan& plan) {
    const std::size_t most = edges.count / plan.columns;
    const std::int32_t* edge = edges.place.data() + plan.columns;
    for (std::size_t row = 0; row < most; ++row, edge += plan.columns) {
        if (text[*edge] != plan.line_end) return row;
    }
    return most;
}

/// How many rows from the first on have each separator where it belongs.
std::size_t regular_rows(const char* text, const Edges& edges, const RowPlan& plan) {
    const std::size_t ended = ended_rows(text, edges, plan);
    // Then there is no line end but the last of each row.
    if (!edges.quotes && ended == edges.line_ends) return ended;
    const std::int32_t* edge = edges.place.data() + 1;
    for (std::size_t row = 0; row < ended; ++row, edge += plan.columns) {
        for (std::size_t c = 0; c + 1 < plan.columns; ++c) {
            if (text[edge[c]] != plan.rules.delimiter) return row;
        }
    }
    return ended;
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
        find_row_ends(regular);
        read_columns(regular);
        note_places(regular);
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
    /// Without a carriage return before it.
    void find_row_ends(std::size_t rows) {
        const std::int32_t* edge = edges_.place.data() + plan_.columns;
        for (std::size_t row = 0; row < rows; ++row, edge += plan_.columns) row_ends_[row] = *edge;
        if (!edges_.returns) return;
        for (std::size_t row = 0; row < rows; ++row) {
            const std::int32_t end = row_ends_[row];
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
        for (const WantedColumn& wanted : plan_.wanted) {
            const bool last = wanted.column + 1 == plan_.columns;
            const std::int32_t* const before = edges_.place.data() + unread * plan_.columns + wanted.column;
            const CellColumn cells{text_,
                                   before,
                                   last ? row_ends_.data() + unread : before + 1,
                                   plan_.columns,
                                   last ? 1 : plan_.columns,
                                   rows - unread,
                                   plan_.rules.decimal_mark};
            double* const numbers = sink_.numbers(wanted.slot) + unread;
            if (read_cells_avx2(cells, numbers, odd_.data() + unread)) any_odd_ = true;
        }
    }

    void note_places(std::size_t rows) {
        const auto shift = static_cast<std::uint32_t>(begin_);
        std::uint32_t* const ends = sink_.row_ends();
        for (std::size_t row = 0; row < rows; ++row)
            ends[row] = shift + static_cast<std::uint32_t>(row_ends_[row]);
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
            if (!parser_.parse(text_ + row_begin(row), text_ + row_ends_[row], parsed_)) return row;
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
    std::array<std::int32_t, stretch_bytes + 64> row_ends_;  ///< offsets from text_
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
