// SPDX-License-Identifier: MIT
// Two cells at a time, each from one load that ends where the cell ends: no step waits for the length of the
// number before it.
#include "log/text/cell_columns.hpp"
#include "log/text/x86_vectors.hpp"

#if defined(RIPPLENOTCH_X86_VECTORS)
#include <bit>

#include "log/text/cell_masks.hpp"
#include "ripplenotch/core/number.hpp"

namespace ripplenotch {
namespace {

WITH_AVX2 inline __m128i half(const std::uint8_t* bytes) {
    return _mm_load_si128(reinterpret_cast<const __m128i*>(bytes));
}

WITH_AVX2 inline __m256i halves(const std::uint8_t* low, const std::uint8_t* high) {
    return _mm256_inserti128_si256(_mm256_castsi128_si256(half(low)), half(high), 1);
}

WITH_AVX2 inline __m256i ends(const char* low_end, const char* high_end) {
    const auto load = [](const char* end) WITH_AVX2 {
        return _mm_loadu_si128(reinterpret_cast<const __m128i*>(end - lane_bytes));
    };
    return _mm256_inserti128_si256(_mm256_castsi128_si256(load(low_end)), load(high_end), 1);
}

WITH_AVX2 inline __m256i whole_load(const void* bytes) {
    return _mm256_loadu_si256(static_cast<const __m256i*>(bytes));
}

/// Of each lane's sixteen digits, the most significant first: the whole number, twice in the lane. By sums of
/// neighbours (10, 100, 10000, 100000000).
WITH_AVX2 inline __m256i sixteens(__m256i digits) {
    __m256i sums = _mm256_maddubs_epi16(digits, _mm256_set1_epi16(0x010A));
    sums = _mm256_madd_epi16(sums, _mm256_set1_epi32(0x00010064));
    sums = _mm256_packus_epi32(sums, sums);
    sums = _mm256_madd_epi16(sums, _mm256_set1_epi32(0x00012710));
    return _mm256_add_epi64(_mm256_mul_epu32(sums, _mm256_set1_epi64x(100000000)),
                            _mm256_srli_epi64(sums, 32));
}

/// Where the marks of two numbers are.
struct Places {
    __m256i offset, most, spare, close;
    __m128d powers;
};

WITH_AVX2 inline Places places_of(std::size_t low, std::size_t high, char decimal_mark) {
    Places places;
    const __m256i apart = halves(cell_masks.apart[low].data(), cell_masks.apart[high].data());
    places.spare = halves(cell_masks.spare[low].data(), cell_masks.spare[high].data());
    places.most = halves(cell_masks.most[low].data(), cell_masks.most[high].data());
    places.close = halves(cell_masks.close[low].data(), cell_masks.close[high].data());
    places.offset = _mm256_blendv_epi8(_mm256_set1_epi8(decimal_mark), _mm256_set1_epi8('0'), apart);
    places.powers = _mm_set_pd(cell_masks.power[high], cell_masks.power[low]);
    return places;
}

/// The cells of two rows, and which of their bytes belong to the numbers.
struct Pair {
    __m256i text, keep;
    std::size_t low_minus, high_minus;
};

/// False where one of two numbers is empty or longer than a lane.
template <bool plain>
WITH_AVX2 inline bool load_pair(const CellCursor& at, Pair& pair) {
    const std::int32_t* const end = plain ? at.before + 1 : at.end;
    const std::size_t end_stride = plain ? at.before_stride : at.end_stride;
    const std::int64_t low_before = at.before[0], high_before = at.before[at.before_stride];
    const std::int64_t low_end = end[0], high_end = end[end_stride];
    pair.low_minus = at.text[low_before + 1] == '-' ? 1 : 0;
    pair.high_minus = at.text[high_before + 1] == '-' ? 1 : 0;
    // With the separator before it.
    const auto low = static_cast<std::size_t>(low_end - low_before) - pair.low_minus;
    const auto high = static_cast<std::size_t>(high_end - high_before) - pair.high_minus;
    if (!plain && ((low - 2) | (high - 2)) >= lane_bytes) return false;
    pair.keep = halves(cell_masks.keep[low - 1].data(), cell_masks.keep[high - 1].data());
    pair.text = ends(at.text + low_end, at.text + high_end);
    return true;
}

/// True where every byte that belongs to a number is a digit, or the mark in its place, and it has what it
/// needs. Leaves the values of the digits.
WITH_AVX2 inline bool all_known(const Pair& pair, const Places& places, __m256i& values) {
    const __m256i rest = _mm256_sub_epi8(pair.text, places.offset);
    const __m256i known = _mm256_cmpeq_epi8(_mm256_min_epu8(rest, places.most), rest);
    values = _mm256_and_si256(rest, pair.keep);
    const __m256i right = _mm256_blendv_epi8(places.spare, known, pair.keep);
    return _mm256_testc_si256(right, _mm256_set1_epi8(-1)) != 0;
}

/// Most columns have the decimal mark in the same place, counted from the end, all the way down: pairs of
/// rows are read as long as it is there.
class Pairs {
  public:
    explicit Pairs(char decimal_mark)
        : decimal_mark_(decimal_mark), places_(places_of(lane_bytes, lane_bytes, decimal_mark)) {}

    /// For the marks of two rows; false where these cannot be read: junk, more than one mark, long numbers,
    /// or nothing behind a mark, which could stand alone in the next cell.
    WITH_AVX2 bool find_places(const CellColumn& column, std::size_t row) {
        Pair pair;
        if (!load_pair<false>(CellCursor(column, row), pair)) return false;
        const __m256i is_mark = _mm256_cmpeq_epi8(pair.text, _mm256_set1_epi8(decimal_mark_));
        const auto marks =
            static_cast<std::uint32_t>(_mm256_movemask_epi8(_mm256_and_si256(is_mark, pair.keep)));
        const auto low = static_cast<std::size_t>(std::countr_zero((marks & 0xFFFFU) | 0x10000U));
        const auto high = static_cast<std::size_t>(std::countr_zero((marks >> 16) | 0x10000U));
        if (low == lane_bytes - 1 || high == lane_bytes - 1) return false;
        places_ = places_of(low, high, decimal_mark_);
        __m256i values;
        return all_known(pair, places_, values);
    }

    /// From `row` on; returns where the marks are elsewhere, or where it is not sure.
    std::size_t read(const CellColumn& column, std::size_t row, double* numbers) const {
        return column.plain ? read_as<true>(column, row, numbers) : read_as<false>(column, row, numbers);
    }

  private:
    // Not inlined: all that it needs of vectors stays in registers.
    template <bool plain>
    [[gnu::noinline]] WITH_AVX2 std::size_t read_as(const CellColumn& column, std::size_t row,
                                                    double* numbers) const {
        const Places places = places_;
        const __m128i magic = _mm_set1_epi64x(0x4330000000000000);  // 2^52 as a double's bits
        CellCursor at(column, row);
        for (const std::size_t end = column.rows; row + 1 < end; row += 2, at.advance(2)) {
            Pair pair;
            __m256i values;
            if (!load_pair<plain>(at, pair) || !all_known(pair, places, values)) break;
            const __m256i whole = sixteens(_mm256_shuffle_epi8(values, places.close));
            const __m128i both =
                _mm_unpacklo_epi64(_mm256_castsi256_si128(whole), _mm256_extracti128_si256(whole, 1));
            const __m128d mantissas =
                _mm_sub_pd(_mm_castsi128_pd(_mm_or_si128(both, magic)), _mm_castsi128_pd(magic));
            const __m128d signs = _mm_load_pd(cell_masks.signs[2 * pair.high_minus + pair.low_minus].data());
            _mm_storeu_pd(numbers + row, _mm_xor_pd(_mm_div_pd(mantissas, places.powers), signs));
        }
        return row;
    }

    char decimal_mark_;
    Places places_;
};

/// Of one cell with up to 32 characters and 19 digits; false where it is not sure.
WITH_AVX2 bool read_long_cell(const CellCursor& at, char decimal_mark, double& value) {
    const char* const begin = at.text + at.before[0] + 1;
    const char* const end = at.text + at.end[0];
    const bool negative = *begin == '-';
    const std::size_t length = static_cast<std::size_t>(end - begin) - (negative ? 1 : 0);
    if (length - 1 >= 32) return false;
    const __m256i keep = whole_load(cell_masks.keep_long[length].data());
    const __m256i text = whole_load(end - 32), zero = _mm256_set1_epi8('0');
    const __m256i digits = _mm256_sub_epi8(text, zero);
    const __m256i is_mark = _mm256_cmpeq_epi8(text, _mm256_set1_epi8(decimal_mark));
    const __m256i is_digit = _mm256_cmpeq_epi8(_mm256_min_epu8(digits, _mm256_set1_epi8(9)), digits);
    const auto marks = static_cast<std::uint32_t>(_mm256_movemask_epi8(_mm256_and_si256(is_mark, keep)));
    if (_mm256_testc_si256(_mm256_or_si256(is_digit, is_mark), keep) == 0) return false;
    if ((marks & (marks - 1)) != 0 || (marks != 0 && length == 1)) return false;
    // What stands before the mark moves up by one: taken from a load one byte earlier.
    const std::size_t decimals = marks == 0 ? 0 : 31 - static_cast<std::size_t>(std::countr_zero(marks));
    const __m256i behind = whole_load(cell_masks.keep_long[marks == 0 ? 32 : decimals].data());
    const __m256i before = _mm256_andnot_si256(behind, whole_load(cell_masks.keep_long[length - 1].data()));
    const __m256i moved = _mm256_and_si256(_mm256_sub_epi8(whole_load(end - 33), zero), before);
    const __m256i kept = _mm256_and_si256(_mm256_and_si256(digits, keep), behind);
    const __m256i whole = sixteens(_mm256_or_si256(kept, moved));
    const auto high = static_cast<std::uint64_t>(_mm256_extract_epi64(whole, 0));
    const auto low = static_cast<std::uint64_t>(_mm256_extract_epi64(whole, 2));
    if (high > 999) return false;  // more than 19 digits may not fit
    const auto magnitude = decimal_number(high * most_lane_digits + low, -static_cast<int>(decimals));
    if (!magnitude) return false;
    value = negative ? -*magnitude : *magnitude;
    return true;
}

}  // namespace

bool read_cells_avx2(const CellColumn& column, double* numbers, std::uint8_t* odd) {
    Pairs pairs(column.decimal_mark);
    bool any_odd = false;
    std::size_t row = 0;
    while (row < column.rows) {
        row = pairs.read(column, row, numbers);
        if (row + 1 < column.rows && pairs.find_places(column, row)) continue;
        // Numbers that are too long for pairs seldom come alone.
        CellCursor at(column, row);
        for (int alone = 0; row < column.rows && (alone < 2 || at.length() > lane_bytes); ++alone) {
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
#endif
