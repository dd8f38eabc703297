// SPDX-License-Identifier: MIT
#pragma once
// Internal to bytes.hpp: each half in a register of NEON. What the functions do stands in bytes_avx2.hpp.

#include <arm_neon.h>

#include <cstdint>

#include "core/vectors/lanes.hpp"

#define RIPPLENOTCH_INLINED_WIDE RIPPLENOTCH_INLINED

namespace ripplenotch {

template <class Number>
using Wide = TwoRegisters<Number>;

template <class To, class From>
RIPPLENOTCH_INLINED_WIDE Wide<To> as(const Wide<From>& lanes) {
    return {reinterpret_cast<HalfRegister<To>>(lanes.low), reinterpret_cast<HalfRegister<To>>(lanes.high)};
}

RIPPLENOTCH_INLINED_WIDE Wide<std::uint8_t> load_halves(const void* low, const void* high) {
    return {vld1q_u8(static_cast<const std::uint8_t*>(low)),
            vld1q_u8(static_cast<const std::uint8_t*>(high))};
}

RIPPLENOTCH_INLINED_WIDE Wide<std::uint8_t> shuffle(const Wide<std::uint8_t>& bytes,
                                                    const Wide<std::uint8_t>& from) {
    return {vqtbl1q_u8(bytes.low, from.low), vqtbl1q_u8(bytes.high, from.high)};
}

RIPPLENOTCH_INLINED_WIDE Wide<std::uint8_t> choose(const Wide<std::uint8_t>& mask,
                                                   const Wide<std::uint8_t>& where_set,
                                                   const Wide<std::uint8_t>& elsewhere) {
    return {vbslq_u8(mask.low, where_set.low, elsewhere.low),
            vbslq_u8(mask.high, where_set.high, elsewhere.high)};
}
template <class Number>
RIPPLENOTCH_INLINED_WIDE std::uint32_t bits_of(const Wide<Number>& mask) {
    constexpr uint8x16_t weights = {1, 2, 4, 8, 16, 32, 64, 128, 1, 2, 4, 8, 16, 32, 64, 128};
    const Wide<std::uint8_t> bytes = as<std::uint8_t>(mask);
    uint8x16_t sums = vpaddq_u8(bytes.low & weights, bytes.high & weights);
    sums = vpaddq_u8(sums, sums);
    return vgetq_lane_u32(vreinterpretq_u32_u8(vpaddq_u8(sums, sums)), 0);
}
template <class Number>
RIPPLENOTCH_INLINED_WIDE bool every(const Wide<Number>& mask) {
    const Wide<std::uint8_t> bytes = as<std::uint8_t>(mask);
    return vminvq_u8(bytes.low & bytes.high) == 0xFF;
}

/// In two sums of up to eight digits.
RIPPLENOTCH_INLINED uint64x2_t digits_by_eight(uint8x16_t digits) {
    const uint16x8_t twos =
        vpaddlq_u8(digits * uint8x16_t{10, 1, 10, 1, 10, 1, 10, 1, 10, 1, 10, 1, 10, 1, 10, 1});
    const uint32x4_t fours = vpaddlq_u16(twos * uint16x8_t{100, 1, 100, 1, 100, 1, 100, 1});
    return vpaddlq_u32(fours * uint32x4_t{10000, 1, 10000, 1});
}
RIPPLENOTCH_INLINED_WIDE HalfRegister<std::uint64_t> sixteen_digits(const Wide<std::uint8_t>& digits) {
    const uint64x2_t low = digits_by_eight(digits.low), high = digits_by_eight(digits.high);
    const uint64x2_t first = vuzp1q_u64(low, high), last = vuzp2q_u64(low, high);
    return vmull_u32(vmovn_u64(first), vdup_n_u32(100000000)) + last;
}

}  // namespace ripplenotch
