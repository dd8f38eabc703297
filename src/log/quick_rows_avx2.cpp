// SPDX-License-Identifier: MIT
// Two stages: find the delimiters of a stretch of text, 64 bytes at a time, then turn each wanted cell into a
// number from one load that ends where the cell ends. No step waits for the length of the number before it.
#include "log/quick_rows_avx2.hpp"

#if defined(__x86_64__) && defined(__GNUC__)
#define RIPPLENOTCH_AVX2 1
#include <immintrin.h>
#endif

#include <bit>
#include <cstdint>
#include <limits>

#include "log/row_sink.hpp"

namespace ripplenotch {

#if defined(RIPPLENOTCH_AVX2)
namespace {

constexpr std::size_t stretch_bytes = 8192;
constexpr std::size_t vector_bytes = 16;  // of a cell
constexpr std::uint64_t largest_exact = std::uint64_t{1} << 53;

constexpr std::array<double, 17> powers_of_ten = {1e0, 1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7, 1e8,
                                                  1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16};

/// Byte masks: keep the last L bytes; close the gap that a decimal mark at place d leaves.
struct Masks {
    alignas(16) std::array<std::array<std::uint8_t, 16>, 17> keep{};
    alignas(16) std::array<std::array<std::uint8_t, 16>, 17> close{};
    constexpr Masks() {
        for (std::size_t length = 0; length <= 16; ++length) {
            for (std::size_t i = 0; i < 16; ++i) keep[length][i] = i >= 16 - length ? 0xFF : 0;
        }
        for (std::size_t mark = 0; mark <= 16; ++mark) {
            for (std::size_t i = 0; i < 16; ++i) {
                const auto from = static_cast<std::uint8_t>(i == 0 ? 0x80 : i - 1);  // 0x80 gives a zero
                close[mark][i] = mark < 16 && i <= mark ? from : static_cast<std::uint8_t>(i);
            }
        }
    }
};
constexpr Masks masks;

__attribute__((target("avx2"))) inline __m128i load(const std::uint8_t* bytes) {
    return _mm_load_si128(reinterpret_cast<const __m128i*>(bytes));
}

/// Sixteen digits, the most significant first, by sums of neighbours: 10, 100, 10000, 100000000.
__attribute__((target("avx2"))) inline std::uint64_t whole_number(__m128i digits) {
    __m128i sums = _mm_maddubs_epi16(digits, _mm_set1_epi16(0x010A));
    sums = _mm_madd_epi16(sums, _mm_set1_epi32(0x00010064));
    sums = _mm_packus_epi32(sums, sums);
    sums = _mm_madd_epi16(sums, _mm_set1_epi32(0x00012710));
    const auto halves = static_cast<std::uint64_t>(_mm_cvtsi128_si64(sums));
    return (halves & 0xFFFFFFFFU) * 100000000U + (halves >> 32);
}

/// Reads [-]digits[mark digits] of at most 16 characters after the sign. Mantissa and power of ten are exact
/// doubles, so one division rounds correctly. 16 bytes before `end` must be readable.
__attribute__((target("avx2"))) inline bool read_cell(const char* begin, const char* end, __m128i mark,
                                                      double& value) {
    const bool negative = *begin == '-';
    const std::size_t length = static_cast<std::size_t>(end - begin) - (negative ? 1 : 0);
    if (length - 1 >= vector_bytes) return false;
    const __m128i text = _mm_loadu_si128(reinterpret_cast<const __m128i*>(end - vector_bytes));
    const __m128i keep = load(masks.keep[length].data());
    const __m128i is_mark = _mm_cmpeq_epi8(text, mark);
    const auto marks = static_cast<std::uint32_t>(_mm_movemask_epi8(_mm_and_si128(is_mark, keep)));
    __m128i digits = _mm_sub_epi8(text, _mm_set1_epi8('0'));
    const __m128i is_digit = _mm_cmpeq_epi8(_mm_min_epu8(digits, _mm_set1_epi8(9)), digits);
    const __m128i junk = _mm_andnot_si128(_mm_or_si128(is_digit, is_mark), keep);
    const bool lone_mark = marks != 0 && length == 1;
    if (_mm_testz_si128(junk, junk) == 0 || (marks & (marks - 1)) != 0 || lone_mark) return false;
    const auto place = static_cast<std::size_t>(std::countr_zero(marks | 0x10000U));
    digits = _mm_shuffle_epi8(_mm_and_si128(digits, keep), load(masks.close[place].data()));
    const std::uint64_t mantissa = whole_number(digits);
    if (mantissa > largest_exact) return false;
    const std::size_t decimals = place == vector_bytes ? 0 : vector_bytes - 1 - place;
    const double magnitude =
        static_cast<double>(static_cast<std::int64_t>(mantissa)) / powers_of_ten[decimals];
    // g++ 12 makes much slower code of setting the sign's bit.
    value = negative ? -magnitude : magnitude;
    return true;
}

struct Separators {
    std::array<std::uint32_t, stretch_bytes + 64> place;  // offsets into the stretch
    std::size_t count = 0;
};

/// Offsets of delimiters, line ends and quotes.
__attribute__((target("avx2"))) void find_separators(const char* text, std::size_t size, char delimiter,
                                                     char line_end, Separators& found) {
    const __m256i delimiters = _mm256_set1_epi8(delimiter), ends = _mm256_set1_epi8(line_end),
                  quotes = _mm256_set1_epi8('"');
    const auto hits = [&](const char* at) __attribute__((target("avx2"))) {
        const __m256i bytes = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(at));
        const __m256i any = _mm256_or_si256(
            _mm256_cmpeq_epi8(bytes, quotes),
            _mm256_or_si256(_mm256_cmpeq_epi8(bytes, delimiters), _mm256_cmpeq_epi8(bytes, ends)));
        return static_cast<std::uint32_t>(_mm256_movemask_epi8(any));
    };
    std::uint32_t* into = found.place.data();
    std::size_t at = 0;
    for (; at + 64 <= size; at += 64) {
        std::uint64_t bits = hits(text + at) | static_cast<std::uint64_t>(hits(text + at + 32)) << 32;
        const int count = std::popcount(bits);
        // Eight places without a branch, most often all there are.
        for (int i = 0; i < 8; ++i, bits &= bits - 1)
            into[i] = static_cast<std::uint32_t>(at) + static_cast<std::uint32_t>(std::countr_zero(bits));
        for (int i = 8; i < count; ++i, bits &= bits - 1)
            into[i] = static_cast<std::uint32_t>(at) + static_cast<std::uint32_t>(std::countr_zero(bits));
        into += count;
    }
    for (; at < size; ++at) {
        if (text[at] == delimiter || text[at] == line_end || text[at] == '"')
            *into++ = static_cast<std::uint32_t>(at);
    }
    found.count = static_cast<std::size_t>(into - found.place.data());
}

}  // namespace

bool has_avx2() {
    static const bool has = __builtin_cpu_supports("avx2") != 0;
    return has;
}

__attribute__((target("avx2"))) std::size_t take_rows_avx2(RowBlock& block, std::size_t begin,
                                                           double time_before, const RowPlan& plan,
                                                           const RowParser& parser) {
    const std::string_view bytes = block.bytes;
    const __m128i mark = _mm_set1_epi8(plan.rules.decimal_mark);
    const bool timed = !plan.wanted.empty() &&
                       std::any_of(plan.wanted.begin(), plan.wanted.end(),
                                   [](const WantedColumn& wanted) { return wanted.slot == time_slot; });
    RowSink sink(block, begin, plan);
    Separators found;
    ParsedRow row;
    while (begin < bytes.size()) {
        const char* const text = bytes.data() + begin;
        find_separators(text, std::min(stretch_bytes, bytes.size() - begin), plan.rules.delimiter,
                        plan.line_end, found);
        std::size_t row_begin = 0, next = 0;  // in the stretch
        for (; next + plan.columns <= found.count; next += plan.columns) {
            const std::uint32_t* const separator = found.place.data() + next;
            bool regular = text[separator[plan.columns - 1]] == plan.line_end;
            for (std::size_t c = 0; c + 1 < plan.columns; ++c)
                regular = regular && text[separator[c]] == plan.rules.delimiter;
            if (!regular) break;
            std::size_t row_end = separator[plan.columns - 1];
            const std::size_t after = row_end + 1;
            if (row_end > row_begin && text[row_end - 1] == '\r') --row_end;
            bool read = begin + row_begin >= vector_bytes;
            std::size_t torque_begin = row_begin, torque_end = row_begin;
            for (const WantedColumn& wanted : plan.wanted) {
                const std::size_t from = wanted.column == 0 ? row_begin : separator[wanted.column - 1] + 1;
                const std::size_t to = wanted.column + 1 == plan.columns ? row_end : separator[wanted.column];
                read = read && read_cell(text + from, text + to, mark, row.values[wanted.slot]);
                if (wanted.slot != torque_slot) continue;
                torque_begin = from;
                torque_end = to;
            }
            if (!read) {
                if (!parser.parse(text + row_begin, text + row_end, row)) break;
                if (row.torque_begin != nullptr) {
                    torque_begin = static_cast<std::size_t>(row.torque_begin - text);
                    torque_end = static_cast<std::size_t>(row.torque_end - text);
                }
            }
            if (timed && row.values[time_slot] < time_before) break;
            time_before = row.values[time_slot];
            sink.add(row.values, begin + torque_begin, begin + torque_end, begin + row_end);
            row_begin = after;
        }
        if (row_begin == 0) break;  // an irregular row, or one longer than the stretch
        begin += row_begin;
    }
    sink.finish();
    return begin;
}

#else

bool has_avx2() { return false; }
std::size_t take_rows_avx2(RowBlock&, std::size_t begin, double, const RowPlan&, const RowParser&) {
    return begin;
}

#endif

}  // namespace ripplenotch
