// SPDX-License-Identifier: MIT
#pragma once
// Internal to bytes.hpp: both halves in one register of AVX2.

#include <immintrin.h>

#include <cstdint>

#include "core/vectors/lanes.hpp"

#define RIPPLENOTCH_INLINED_WIDE RIPPLENOTCH_INLINED RIPPLENOTCH_WIDE

namespace ripplenotch {

template <class Number>
using Wide = OneRegister<Number>;

/// The same bits as other numbers.
template <class To, class Lanes>
RIPPLENOTCH_INLINED_WIDE Wide<To> as(const Lanes& lanes) {
    return reinterpret_cast<Wide<To>>(lanes);
}
template <class Lanes>
RIPPLENOTCH_INLINED_WIDE __m256i whole(const Lanes& lanes) {
    return reinterpret_cast<__m256i>(lanes);
}

/// Halves from sixteen bytes each.
RIPPLENOTCH_INLINED_WIDE Wide<std::uint8_t> load_halves(const void* low, const void* high) {
    const auto load = [](const void* from)
                          RIPPLENOTCH_WIDE { return _mm_loadu_si128(static_cast<const __m128i*>(from)); };
    return as<std::uint8_t>(_mm256_inserti128_si256(_mm256_castsi128_si256(load(low)), load(high), 1));
}

/// In each half: byte from[i] of it, or zero where that is 0x80 or more.
RIPPLENOTCH_INLINED_WIDE Wide<std::uint8_t> shuffle(const Wide<std::uint8_t>& bytes,
                                                    const Wide<std::uint8_t>& from) {
    return as<std::uint8_t>(_mm256_shuffle_epi8(whole(bytes), whole(from)));
}

// Of bytes that are all ones or zero each: by mask, one bit a byte, whether all or none are set.
RIPPLENOTCH_INLINED_WIDE Wide<std::uint8_t> choose(const Wide<std::uint8_t>& mask,
                                                   const Wide<std::uint8_t>& where_set,
                                                   const Wide<std::uint8_t>& elsewhere) {
    return as<std::uint8_t>(_mm256_blendv_epi8(whole(elsewhere), whole(where_set), whole(mask)));
}
template <class Lanes>
RIPPLENOTCH_INLINED_WIDE std::uint32_t bits_of(const Lanes& mask) {
    return static_cast<std::uint32_t>(_mm256_movemask_epi8(whole(mask)));
}
template <class Lanes>
RIPPLENOTCH_INLINED_WIDE bool every(const Lanes& mask) {
    return _mm256_testc_si256(whole(mask), _mm256_set1_epi8(-1)) != 0;
}

/// Of each half's sixteen digits, the most significant first: the whole number, by sums of neighbours (10,
/// 100, 10000, 100000000).
RIPPLENOTCH_INLINED_WIDE HalfRegister<std::uint64_t> sixteen_digits(const Wide<std::uint8_t>& digits) {
    __m256i sums = _mm256_maddubs_epi16(whole(digits), _mm256_set1_epi16(0x010A));
    sums = _mm256_madd_epi16(sums, _mm256_set1_epi32(0x00010064));
    sums = _mm256_packus_epi32(sums, sums);
    sums = _mm256_madd_epi16(sums, _mm256_set1_epi32(0x00012710));
    sums =
        _mm256_add_epi64(_mm256_mul_epu32(sums, _mm256_set1_epi64x(100000000)), _mm256_srli_epi64(sums, 32));
    return reinterpret_cast<HalfRegister<std::uint64_t>>(
        _mm_unpacklo_epi64(_mm256_castsi256_si128(sums), _mm256_extracti128_si256(sums, 1)));
}

}  // namespace ripplenotch
