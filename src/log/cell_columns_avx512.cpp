// SPDX-License-Identifier: MIT
// Four cells at a time, as cell_columns_avx2.cpp reads two; masks are bits in a general register.
#include "log/cell_groups.hpp"
#include "log/x86_vectors.hpp"

#if defined(RIPPLENOTCH_X86_VECTORS)
#include <bit>

#include "log/cell_masks.hpp"

namespace ripplenotch {
namespace {

constexpr std::size_t cells = 4;
constexpr std::uint64_t one = 1;
using FourPlaces = std::array<std::size_t, cells>;

WITH_AVX512 inline __m512i lanes(const void* a, const void* b, const void* c, const void* d) {
    const auto load = [](const void* bytes)
                          WITH_AVX512 { return _mm_loadu_si128(static_cast<const __m128i*>(bytes)); };
    __m512i all = _mm512_castsi128_si512(load(a));
    all = _mm512_inserti32x4(all, load(b), 1);
    all = _mm512_inserti32x4(all, load(c), 2);
    return _mm512_inserti32x4(all, load(d), 3);
}

template <typename Table>
WITH_AVX512 inline __m512i lanes_of(const Table& table, const FourPlaces& at) {
    return lanes(table[at[0]].data(), table[at[1]].data(), table[at[2]].data(), table[at[3]].data());
}

/// Where the marks of four numbers are; `needed` has the bit of each, or of the last digit where there is
/// none.
struct Places {
    __m512i offset, most, close;
    __m256d powers;
    std::uint64_t needed;
};

WITH_AVX512 inline Places places_of(const FourPlaces& at, char decimal_mark) {
    Places places;
    places.most = lanes_of(cell_masks.most, at);
    places.close = lanes_of(cell_masks.close, at);
    const __mmask64 marks = _mm512_cmpeq_epi8_mask(lanes_of(cell_masks.apart, at), _mm512_setzero_si512());
    places.offset = _mm512_mask_blend_epi8(marks, _mm512_set1_epi8('0'), _mm512_set1_epi8(decimal_mark));
    places.powers = _mm256_set_pd(cell_masks.power[at[3]], cell_masks.power[at[2]], cell_masks.power[at[1]],
                                  cell_masks.power[at[0]]);
    places.needed = 0;
    for (std::size_t lane = 0; lane < cells; ++lane)
        places.needed |= one << (lane_bytes * lane + std::min(at[lane], lane_bytes - 1));
    return places;
}

/// The cells of four rows; bits: the bytes of the numbers, and minus signs before them.
struct Quartet {
    __m512i text;
    std::uint64_t keep, minus;
};

/// False where one of four cells is empty or longer than a lane, its sign included.
template <bool plain>
WITH_AVX512 inline bool load_quartet(const CellCursor& at, Quartet& quartet) {
    const std::int32_t *const before = at.before, *const end = plain ? at.before + 1 : at.end;
    const std::size_t stride = at.before_stride, step = plain ? stride : at.end_stride;
    const std::int64_t end_0 = end[0], end_1 = end[step], end_2 = end[2 * step], end_3 = end[3 * step];
    // With the separator before it.
    const auto length_0 = static_cast<std::uint64_t>(end_0 - before[0]);
    const auto length_1 = static_cast<std::uint64_t>(end_1 - before[stride]);
    const auto length_2 = static_cast<std::uint64_t>(end_2 - before[2 * stride]);
    const auto length_3 = static_cast<std::uint64_t>(end_3 - before[3 * stride]);
    if (!plain && ((length_0 - 2) | (length_1 - 2) | (length_2 - 2) | (length_3 - 2)) >= lane_bytes)
        return false;
    // The first byte of each, so that their sum taken from the ends of the lanes leaves all of them; the last
    // lane's end is bit 64.
    const std::uint64_t first = ((one << 17) >> length_0) + ((one << 33) >> length_1) +
                                ((one << 49) >> length_2) + ((one << 63) >> ((length_3 - 2) & 63));
    constexpr std::uint64_t lane_ends = (one << 16) + (one << 32) + (one << 48);
    const char* const text = at.text - lane_bytes;
    quartet.text = lanes(text + end_0, text + end_1, text + end_2, text + end_3);
    quartet.minus = _mm512_mask_cmpeq_epi8_mask(first, quartet.text, _mm512_set1_epi8('-'));
    quartet.keep = (lane_ends - first) & ~quartet.minus;
    return true;
}

/// As of pairs; leaves the values of the digits.
WITH_AVX512 inline bool all_known(const Quartet& quartet, const Places& places, __m512i& values) {
    values = _mm512_maskz_sub_epi8(quartet.keep, quartet.text, places.offset);
    const __mmask64 known = _mm512_cmple_epu8_mask(values, places.most);
    return _kortestc_mask64_u8(known, known) != 0 && (places.needed & ~quartet.keep) == 0;
}

class Quartets {
  public:
    static constexpr std::size_t rows = cells;
    explicit Quartets(char decimal_mark)
        : decimal_mark_(decimal_mark),
          places_(places_of({lane_bytes, lane_bytes, lane_bytes, lane_bytes}, decimal_mark)) {}

    WITH_AVX512 bool find_places(const CellColumn& column, std::size_t row) {
        Quartet quartet;
        if (!load_quartet<false>(CellCursor(column, row), quartet)) return false;
        const std::uint64_t marks =
            quartet.keep & _mm512_cmpeq_epi8_mask(quartet.text, _mm512_set1_epi8(decimal_mark_));
        FourPlaces at{};
        for (std::size_t lane = 0; lane < cells; ++lane) {
            at[lane] = static_cast<std::size_t>(
                std::countr_zero(((marks >> (lane_bytes * lane)) & 0xFFFFU) | 0x10000U));
            if (at[lane] == lane_bytes - 1) return false;
        }
        places_ = places_of(at, decimal_mark_);
        __m512i values;
        return all_known(quartet, places_, values);
    }

    std::size_t read(const CellColumn& column, std::size_t row, double* numbers) const {
        return column.plain ? read_as<true>(column, row, numbers) : read_as<false>(column, row, numbers);
    }

  private:
    // Not inlined: all that it needs of vectors stays in registers.
    template <bool plain>
    WITH_AVX512 [[gnu::noinline]] std::size_t read_as(const CellColumn& column, std::size_t row,
                                                      double* numbers) const {
        const Places places = places_;
        const __m256i even = _mm256_set_epi64x(6, 4, 2, 0);
        const __m256i lane_bits = _mm256_set_epi64x(static_cast<std::int64_t>(0xFFFF000000000000U),
                                                    0xFFFF00000000, 0xFFFF0000, 0xFFFF);
        CellCursor at(column, row);
        for (const std::size_t end = column.rows; row + cells <= end; row += cells, at.advance(cells)) {
            Quartet quartet;
            __m512i values;
            if (!load_quartet<plain>(at, quartet) || !all_known(quartet, places, values)) break;
            __m512i sums =
                _mm512_maddubs_epi16(_mm512_shuffle_epi8(values, places.close), _mm512_set1_epi16(0x010A));
            sums = _mm512_madd_epi16(sums, _mm512_set1_epi32(0x00010064));
            sums = _mm512_packus_epi32(sums, sums);
            sums = _mm512_madd_epi16(sums, _mm512_set1_epi32(0x00012710));
            const __m256i eights =
                _mm512_castsi512_si256(_mm512_permutexvar_epi64(_mm512_castsi256_si512(even), sums));
            const __m256i whole = _mm256_add_epi64(_mm256_mul_epu32(eights, _mm256_set1_epi64x(100000000)),
                                                   _mm256_srli_epi64(eights, 32));
            const __m256d magnitudes = _mm256_div_pd(_mm256_cvtepi64_pd(whole), places.powers);
            const __mmask8 negative = _mm256_test_epi64_mask(
                _mm256_set1_epi64x(static_cast<std::int64_t>(quartet.minus)), lane_bits);
            _mm256_storeu_pd(numbers + row,
                             _mm256_mask_xor_pd(magnitudes, negative, magnitudes, _mm256_set1_pd(-0.0)));
        }
        return row;
    }

    char decimal_mark_;
    Places places_;
};

}  // namespace

WITH_AVX512 bool read_cells_avx512(const CellColumn& column, double* numbers, std::uint8_t* odd) {
    Quartets group(column.decimal_mark);
    return read_groups(group, column, numbers, odd);
}

}  // namespace ripplenotch
#endif
