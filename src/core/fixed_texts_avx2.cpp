// SPDX-License-Identifier: MIT
// Four numbers at a time: scaled and rounded to whole numbers, these split into digits by multiplications,
// all of them in place before and behind the mark, and what comes before the first digit made minus signs:
// the text begins at the last of these, or behind it.
#include "core/fixed_texts_avx2.hpp"

#if defined(__x86_64__) && defined(__GNUC__)
#include <immintrin.h>
#endif

#include <algorithm>
#include <array>
#include <cstddef>

namespace ripplenotch {

#if defined(__x86_64__) && defined(__GNUC__)
#define WITH_AVX2 __attribute__((target("avx2")))
#define INLINED_AVX2 inline __attribute__((always_inline, target("avx2")))
namespace {

constexpr double two_to_52 = 4503599627370496.0;
constexpr double most_short = 99999999.0, most_long = 99999999999999.0;  // eight digits, fourteen

constexpr std::array<double, most_decimals_avx2 + 1> powers_of_ten = {1e0, 1e1, 1e2, 1e3,  1e4,  1e5,  1e6,
                                                                      1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13};

using Bytes = std::array<std::uint8_t, 16>;

/// Where the bytes of a slot come from: the last eight digits, those before them, and what is no digit.
struct Places {
    Bytes low{}, high{};
    Bytes beside_low{}, beside_both{};  ///< the mark, and what a sign may overwrite nothing of
    Bytes low_stop{}, high_stop{};      ///< a one at the digit before the mark, which is always there
    constexpr Places() = default;
    explicit constexpr Places(int decimals) {
        for (int from_right = 0; from_right < 16; ++from_right) {
            const auto at = static_cast<std::size_t>(15 - from_right);
            const bool mark = decimals > 0 && from_right == decimals;
            const int digit = from_right - (decimals > 0 && from_right > decimals ? 1 : 0);
            low[at] = byte(!mark && digit < 8 ? 7 - digit : nothing);
            high[at] = byte(!mark && digit >= 8 && digit < most_digits ? 15 - digit : nothing);
            beside_low[at] = byte(mark ? '.' : digit >= 8 ? '-' : 0);
            beside_both[at] = byte(mark ? '.' : digit >= most_digits ? '-' : 0);
        }
        Bytes& stop = decimals < 8 ? low_stop : high_stop;
        const auto before_mark = static_cast<std::size_t>(7 - decimals % 8);
        stop[before_mark] = stop[before_mark + 8] = 1;
    }

  private:
    static constexpr int nothing = 0x80, most_digits = 14;  // a shuffle by 0x80 gives a zero
    static constexpr std::uint8_t byte(int value) { return static_cast<std::uint8_t>(value); }
};

constexpr auto places = [] {
    std::array<Places, most_decimals_avx2 + 1> all;
    for (int decimals = 0; decimals <= most_decimals_avx2; ++decimals)
        all[static_cast<std::size_t>(decimals)] = Places(decimals);
    return all;
}();

INLINED_AVX2 __m256i twice(const Bytes& bytes) {
    return _mm256_broadcastsi128_si256(_mm_loadu_si128(reinterpret_cast<const __m128i*>(bytes.data())));
}

/// A constant that the compiler does not see through: it would make five shifts and additions of one
/// multiplication, and every constant anew for each number.
INLINED_AVX2 __m256i opaque(__m256i constant) {
    __asm__("" : "+x"(constant));
    return constant;
}

/// Splits numbers into digits.
class Splitter {
  public:
    WITH_AVX2 Splitter()
        : over_10000_(opaque(_mm256_set1_epi64x(3518437209))),
          by_10000_(opaque(_mm256_set1_epi64x(10000))),
          over_100_(opaque(_mm256_set1_epi16(10486))),
          by_100_(opaque(_mm256_set1_epi16(100))),
          over_10_(opaque(_mm256_set1_epi16(6554))),
          by_10_shifted_less_1_(opaque(_mm256_set1_epi16(10 * 256 - 1))) {}

    /// Eight digits, the first in the lowest byte, of the number below 1e8 in the lower half of each lane:
    /// fours, pairs and single digits, each time quotients before remainders.
    INLINED_AVX2 __m256i eight_digits(__m256i numbers) const {
        const __m256i high = _mm256_srli_epi64(_mm256_mul_epu32(numbers, over_10000_), 45);
        const __m256i low = _mm256_sub_epi64(numbers, _mm256_mul_epu32(high, by_10000_));
        const __m256i fours = _mm256_or_si256(high, _mm256_slli_epi64(low, 32));
        const __m256i highs = _mm256_srli_epi16(_mm256_mulhi_epu16(fours, over_100_), 4);
        const __m256i lows = _mm256_sub_epi16(fours, _mm256_mullo_epi16(highs, by_100_));
        const __m256i pairs = _mm256_or_si256(highs, _mm256_slli_epi32(lows, 16));
        const __m256i tens = _mm256_mulhi_epu16(pairs, over_10_);
        // tens + ((pairs - 10 * tens) << 8)
        return _mm256_sub_epi16(_mm256_slli_epi16(pairs, 8), _mm256_mullo_epi16(tens, by_10_shifted_less_1_));
    }

  private:
    __m256i over_10000_, by_10000_, over_100_, by_100_, over_10_, by_10_shifted_less_1_;
};

/// All ones in the bytes before the first digit that is not zero, or that is at a stop.
INLINED_AVX2 __m256i leading_zeros(__m256i digits, __m256i stop) {
    const __m256i seen = _mm256_cmpgt_epi8(_mm256_or_si256(digits, stop), _mm256_setzero_si256());
    return _mm256_andnot_si256(seen, _mm256_add_epi64(seen, _mm256_set1_epi64x(-1)));
}

INLINED_AVX2 __m256i count_bytes(__m256i all_ones_or_none) {
    const __m256i zero = _mm256_setzero_si256();
    return _mm256_sad_epu8(_mm256_sub_epi8(zero, all_ones_or_none), zero);
}

/// From the characters of four numbers, in lanes, to slots: even ones, odd ones.
struct SlotPairs {
    __m256i even, odd;
};

INLINED_AVX2 SlotPairs in_place(__m256i text, __m256i from) {
    return {_mm256_shuffle_epi8(text, from),
            _mm256_shuffle_epi8(text, _mm256_add_epi8(from, _mm256_set1_epi8(8)))};
}

class Printer {
  public:
    WITH_AVX2 Printer(int decimals, char decimal_mark)
        : scale_(_mm256_set1_pd(powers_of_ten[static_cast<std::size_t>(decimals)])),
          short_below_(_mm256_set1_pd(decimals < 8 ? most_short : -1.0)),
          bytes_but_leading_(_mm256_set1_epi64x(8 + (decimals > 0 ? 1 : 0))) {
        const Places& from = places[static_cast<std::size_t>(decimals)];
        low_ = twice(from.low);
        high_ = twice(from.high);
        low_stop_ = twice(from.low_stop);
        high_stop_ = twice(from.high_stop);
        beside_low_ = with_mark(twice(from.beside_low), decimal_mark);
        beside_both_ = with_mark(twice(from.beside_both), decimal_mark);
    }

    /// Four values.
    INLINED_AVX2 void print(const double* values, char* slots, std::uint64_t* lengths) const {
        const __m256d value = _mm256_loadu_pd(values), sign = _mm256_set1_pd(-0.0);
        const __m256d product = _mm256_mul_pd(_mm256_andnot_pd(sign, value), scale_);
        const __m256d raised = _mm256_add_pd(product, raise_);  // which rounds
        const __m256d whole = _mm256_sub_pd(raised, raise_);
        const __m256d off = _mm256_andnot_pd(sign, _mm256_sub_pd(product, whole));
        // The product is off by at most half a unit in its last place, 1.2e-16 of itself.
        const __m256d no_tie = _mm256_cmp_pd(_mm256_sub_pd(_mm256_set1_pd(0.5), off),
                                             _mm256_mul_pd(product, _mm256_set1_pd(4e-16)), _CMP_GT_OQ);
        const __m256d fits = _mm256_cmp_pd(product, _mm256_set1_pd(most_long), _CMP_LT_OQ);
        const __m256i sure = _mm256_castpd_si256(_mm256_and_pd(no_tie, fits));
        const __m256d is_short = _mm256_cmp_pd(product, short_below_, _CMP_LT_OQ);
        const __m256i length = _mm256_movemask_pd(is_short) == 15
                                   ? print_short(_mm256_castpd_si256(raised), slots)
                                   : print_long(whole, slots);
        const __m256i signs = _mm256_srli_epi64(_mm256_castpd_si256(value), 63);
        _mm256_store_si256(reinterpret_cast<__m256i*>(lengths),
                           _mm256_and_si256(_mm256_add_epi64(length, signs), sure));
    }

  private:
    INLINED_AVX2 static __m256i with_mark(__m256i bytes, char mark) {
        const __m256i at = _mm256_cmpeq_epi8(bytes, _mm256_set1_epi8('.'));
        return _mm256_blendv_epi8(bytes, _mm256_set1_epi8(mark), at);
    }

    INLINED_AVX2 __m256i characters(__m256i digits, __m256i leading) const {
        static_assert('0' - '-' == 3);
        return _mm256_sub_epi8(_mm256_add_epi8(digits, zeros_), _mm256_and_si256(leading, threes_));
    }

    INLINED_AVX2 static void store(const SlotPairs& pairs, __m256i beside, char* slots) {
        const __m256i even = _mm256_or_si256(pairs.even, beside), odd = _mm256_or_si256(pairs.odd, beside);
        auto* const into = reinterpret_cast<__m256i*>(slots);
        _mm256_store_si256(into, _mm256_permute2x128_si256(even, odd, 0x20));
        _mm256_store_si256(into + 1, _mm256_permute2x128_si256(even, odd, 0x31));
    }

    /// Below 1e8, in the lower halves; returns lengths without a sign.
    INLINED_AVX2 __m256i print_short(__m256i numbers, char* slots) const {
        const __m256i digits = split_.eight_digits(numbers);
        const __m256i leading = leading_zeros(digits, low_stop_);
        store(in_place(characters(digits, leading), low_), beside_low_, slots);
        return _mm256_sub_epi64(bytes_but_leading_, count_bytes(leading));
    }

    /// Below 1e14.
    INLINED_AVX2 __m256i print_long(__m256d whole, char* slots) const {
        // Half of the last digit more, so that the quotient of a multiple of 1e8 is not rounded below it.
        const __m256d more = _mm256_add_pd(whole, _mm256_set1_pd(0.5));
        const __m256d quotient = _mm256_floor_pd(_mm256_mul_pd(more, _mm256_set1_pd(1e-8)));
        const __m256d rest = _mm256_sub_pd(whole, _mm256_mul_pd(quotient, _mm256_set1_pd(1e8)));
        const __m256i high = split_.eight_digits(_mm256_castpd_si256(_mm256_add_pd(quotient, raise_)));
        const __m256i low = split_.eight_digits(_mm256_castpd_si256(_mm256_add_pd(rest, raise_)));
        const __m256i high_leading = leading_zeros(high, high_stop_);
        const __m256i none_high = _mm256_cmpeq_epi64(high_leading, _mm256_set1_epi64x(-1));
        const __m256i low_leading = _mm256_and_si256(leading_zeros(low, low_stop_), none_high);
        const SlotPairs before = in_place(characters(high, high_leading), high_);
        const SlotPairs last = in_place(characters(low, low_leading), low_);
        store({_mm256_or_si256(before.even, last.even), _mm256_or_si256(before.odd, last.odd)}, beside_both_,
              slots);
        const __m256i leading = _mm256_add_epi64(count_bytes(high_leading), count_bytes(low_leading));
        return _mm256_sub_epi64(_mm256_add_epi64(bytes_but_leading_, _mm256_set1_epi64x(8)), leading);
    }

    Splitter split_;
    __m256d raise_ = _mm256_set1_pd(two_to_52), scale_, short_below_;
    __m256i bytes_but_leading_;
    __m256i zeros_ = opaque(_mm256_set1_epi8('0')), threes_ = opaque(_mm256_set1_epi8(3));
    __m256i low_, high_, low_stop_, high_stop_, beside_low_, beside_both_;
};

}  // namespace

WITH_AVX2 void print_fixed_avx2(std::span<const double> values, int decimals, char decimal_mark, char* slots,
                                std::uint64_t* lengths) {
    const Printer printer(decimals, decimal_mark);
    std::size_t i = 0;
    for (; i + 4 <= values.size(); i += 4) printer.print(values.data() + i, slots + 16 * i, lengths + i);
    if (i == values.size()) return;
    std::array<double, 4> last{};
    std::copy(values.begin() + static_cast<std::ptrdiff_t>(i), values.end(), last.begin());
    printer.print(last.data(), slots + 16 * i, lengths + i);
}

#else

void print_fixed_avx2(std::span<const double> values, int, char, char*, std::uint64_t* lengths) {
    std::fill_n(lengths, values.size(), std::uint64_t{0});
}

#endif
}  // namespace ripplenotch
