// SPDX-License-Identifier: MIT
// Two cells at a time, each from one load that ends where the cell ends: no step waits for the length of the
// number before it.
#include "log/cell_columns_avx2.hpp"

#if defined(__x86_64__) && defined(__GNUC__)
#include <immintrin.h>

#include <array>
#include <bit>

#include "ripplenotch/core/number.hpp"

#define WITH_AVX2 __attribute__((target("avx2")))

namespace ripplenotch {
namespace {

constexpr std::size_t lane_bytes = 16;
constexpr std::uint64_t most_lane_digits = 10000000000000000U;  // 1e16

/// Byte masks by the length of a number: its last bytes; by the place of its mark: the gap that the mark
/// leaves, closed.
struct Masks {
    alignas(16) std::array<std::array<std::uint8_t, lane_bytes>, 17> keep{};
    alignas(16) std::array<std::array<std::uint8_t, lane_bytes>, 17> close{};
    alignas(32) std::array<std::array<std::uint8_t, 32>, 33> keep_long{};
    constexpr Masks() {
        for (std::size_t length = 0; length <= 32; ++length) {
            for (std::size_t i = 0; i < 32; ++i) keep_long[length][i] = i >= 32 - length ? 0xFF : 0;
        }
        for (std::size_t length = 0; length <= lane_bytes; ++length) {
            for (std::size_t i = 0; i < lane_bytes; ++i)
                keep[length][i] = i >= lane_bytes - length ? 0xFF : 0;
        }
        for (std::size_t mark = 0; mark <= lane_bytes; ++mark) {
            for (std::size_t i = 0; i < lane_bytes; ++i) {
                const auto from = static_cast<std::uint8_t>(i == 0 ? 0x80 : i - 1);  // 0x80 gives a zero
                close[mark][i] = mark < lane_bytes && i <= mark ? from : static_cast<std::uint8_t>(i);
            }
        }
    }
};
constexpr Masks masks;

constexpr std::array<double, 17> powers_of_ten = {1e0, 1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7, 1e8,
                                                  1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16};

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

/// Of each lane's sixteen digits, the most significant first: the two whole numbers of eight digits, by sums
/// of neighbours (10, 100, 10000).
WITH_AVX2 inline __m256i eights(__m256i digits) {
    __m256i sums = _mm256_maddubs_epi16(digits, _mm256_set1_epi16(0x010A));
    sums = _mm256_madd_epi16(sums, _mm256_set1_epi32(0x00010064));
    sums = _mm256_packus_epi32(sums, sums);
    return _mm256_madd_epi16(sums, _mm256_set1_epi32(0x00012710));
}

/// The whole number of each lane, twice in it.
WITH_AVX2 inline __m256i sixteens(__m256i digits) {
    const __m256i pair = eights(digits);
    return _mm256_add_epi64(_mm256_mul_epu32(pair, _mm256_set1_epi64x(100000000)),
                            _mm256_srli_epi64(pair, 32));
}

struct DigitBytes {
    __m256i digits, marks;
    bool junk = false;
};

WITH_AVX2 inline DigitBytes digit_bytes(__m256i text, __m256i keep, __m256i mark) {
    const __m256i is_mark = _mm256_cmpeq_epi8(text, mark);
    const __m256i digits = _mm256_sub_epi8(text, _mm256_set1_epi8('0'));
    const __m256i is_digit = _mm256_cmpeq_epi8(_mm256_min_epu8(digits, _mm256_set1_epi8(9)), digits);
    const __m256i known = _mm256_or_si256(is_digit, is_mark);
    return {_mm256_and_si256(digits, keep), _mm256_and_si256(is_mark, keep),
            _mm256_testc_si256(known, keep) == 0};
}

/// One cell without its sign.
struct Number {
    const char *begin, *end;
    bool negative;
    [[nodiscard]] std::size_t length() const { return static_cast<std::size_t>(end - begin); }
};

inline Number number_at(const CellColumn& column, std::size_t row) {
    const std::int32_t* const edge = column.edges + row * column.stride;
    const char* begin = column.text + edge[0] + 1;
    const char* end = column.text + edge[1];
    if (column.last) end -= end[-1] == '\r' && end > begin ? 1 : 0;
    const bool negative = *begin == '-';
    return {begin + (negative ? 1 : 0), end, negative};
}

/// Where the marks of two numbers were: most columns have them in the same place all the way down.
struct Places {
    std::uint32_t marks = ~0U;  ///< a bit for each byte
    __m256i close;
    __m128d powers;
};

/// False when a number has more than one mark, or a mark and nothing else.
WITH_AVX2 bool find_places(std::uint32_t marks, const Number& low, const Number& high, Places& places) {
    const std::uint32_t first = marks & 0xFFFFU, second = marks >> 16;
    if ((first & (first - 1)) != 0 || (second & (second - 1)) != 0) return false;
    if ((first != 0 && low.length() == 1) || (second != 0 && high.length() == 1)) return false;
    const auto a = static_cast<std::size_t>(std::countr_zero(first | 0x10000U));
    const auto b = static_cast<std::size_t>(std::countr_zero(second | 0x10000U));
    const auto power = [](std::size_t place) {
        return powers_of_ten[place == lane_bytes ? 0 : lane_bytes - 1 - place];
    };
    places.close = halves(masks.close[a].data(), masks.close[b].data());
    places.powers = _mm_set_pd(power(b), power(a));
    // A trailing mark could stand alone in the next cell: that one is looked at again.
    const bool trailing = a == lane_bytes - 1 || b == lane_bytes - 1;
    places.marks = trailing ? ~0U : marks;
    return true;
}

/// Mantissas below 2^52 and powers of ten up to 1e15 are exact doubles, so one division rounds correctly
/// (W. D. Clinger, How to read floating point numbers accurately, 1990).
WITH_AVX2 inline bool read_two(const Number& low, const Number& high, __m256i mark, Places& places,
                               double* into) {
    const __m256i keep = halves(masks.keep[low.length()].data(), masks.keep[high.length()].data());
    const DigitBytes bytes = digit_bytes(ends(low.end, high.end), keep, mark);
    if (bytes.junk) return false;
    const auto marks = static_cast<std::uint32_t>(_mm256_movemask_epi8(bytes.marks));
    if (marks != places.marks && !find_places(marks, low, high, places)) return false;
    const __m256i whole = sixteens(_mm256_shuffle_epi8(bytes.digits, places.close));
    const __m128i both =
        _mm_unpacklo_epi64(_mm256_castsi256_si128(whole), _mm256_extracti128_si256(whole, 1));
    constexpr std::int64_t two_to_52 = 0x4330000000000000;  // as a double's bits
    if (_mm_testz_si128(both, _mm_set1_epi64x(static_cast<std::int64_t>(~0ULL << 52))) == 0) return false;
    const __m128i magic = _mm_set1_epi64x(two_to_52);
    const __m128d mantissas =
        _mm_sub_pd(_mm_castsi128_pd(_mm_or_si128(both, magic)), _mm_castsi128_pd(magic));
    const __m128i signs = _mm_slli_epi64(_mm_set_epi64x(high.negative ? 1 : 0, low.negative ? 1 : 0), 63);
    _mm_storeu_pd(into, _mm_xor_pd(_mm_div_pd(mantissas, places.powers), _mm_castsi128_pd(signs)));
    return true;
}

/// A number of up to 32 characters and 19 digits.
WITH_AVX2 bool read_long(const Number& number, __m256i mark, double& value) {
    if (number.length() - 1 >= 32) return false;
    const DigitBytes bytes =
        digit_bytes(whole_load(number.end - 32), whole_load(masks.keep_long[number.length()].data()), mark);
    const auto marks = static_cast<std::uint32_t>(_mm256_movemask_epi8(bytes.marks));
    if (bytes.junk || (marks & (marks - 1)) != 0 || (marks != 0 && number.length() == 1)) return false;
    // What stands before the mark moves up by one: taken from a load one byte earlier.
    const std::size_t decimals = marks == 0 ? 0 : 31 - static_cast<std::size_t>(std::countr_zero(marks));
    const __m256i behind = whole_load(masks.keep_long[marks == 0 ? 32 : decimals].data());
    const __m256i before =
        _mm256_andnot_si256(behind, whole_load(masks.keep_long[number.length() - 1].data()));
    const __m256i moved =
        _mm256_and_si256(_mm256_sub_epi8(whole_load(number.end - 33), _mm256_set1_epi8('0')), before);
    const __m256i whole = sixteens(_mm256_or_si256(_mm256_and_si256(bytes.digits, behind), moved));
    const auto high = static_cast<std::uint64_t>(_mm256_extract_epi64(whole, 0));
    const auto low = static_cast<std::uint64_t>(_mm256_extract_epi64(whole, 2));
    if (high > 999) return false;  // more than 19 digits may not fit
    const auto magnitude = decimal_number(high * most_lane_digits + low, -static_cast<int>(decimals));
    if (!magnitude) return false;
    value = number.negative ? -*magnitude : *magnitude;
    return true;
}

}  // namespace

WITH_AVX2 bool read_cells_avx2(const CellColumn& column, double* numbers, std::uint8_t* odd) {
    const __m256i mark = _mm256_set1_epi8(column.decimal_mark);
    Places places{};
    bool any_odd = false;
    const auto alone = [&](const Number& number, std::size_t row) WITH_AVX2 {
        if (read_long(number, mark, numbers[row])) return;
        odd[row] = 1;
        any_odd = true;
    };
    std::size_t row = 0;
    for (; row + 1 < column.rows; row += 2) {
        const Number low = number_at(column, row), high = number_at(column, row + 1);
        const bool short_ones = low.length() - 1 < lane_bytes && high.length() - 1 < lane_bytes;
        if (short_ones && read_two(low, high, mark, places, numbers + row)) continue;
        alone(low, row);
        alone(high, row + 1);
    }
    if (row < column.rows) alone(number_at(column, row), row);
    return any_odd;
}

}  // namespace ripplenotch
#endif
