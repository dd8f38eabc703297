// SPDX-License-Identifier: MIT
#pragma once
// Thirty-two bytes side by side, in two halves of sixteen: characters, or the numbers made of them. For
// functions marked RIPPLENOTCH_WIDE, which are called where wide_vectors() says so.
//
// Sums, comparisons and shifts are those of the language. What it cannot say is written here for each
// instruction set, and nowhere else. Where RIPPLENOTCH_BYTE_VECTORS is not defined there is none.

#include <bit>
#include <cstdint>

#include "core/vectors/lanes.hpp"

#if defined(__x86_64__) && defined(__GNUC__)
#define RIPPLENOTCH_BYTE_VECTORS 1
#include "core/vectors/bytes_avx2.hpp"
#elif defined(__aarch64__) && defined(__GNUC__) && !defined(__AARCH64EB__)
#define RIPPLENOTCH_BYTE_VECTORS 1
#include "core/vectors/bytes_neon.hpp"
#endif

#if defined(RIPPLENOTCH_BYTE_VECTORS)
namespace ripplenotch {

using Bytes = Wide<std::uint8_t>;

RIPPLENOTCH_INLINED_WIDE Bytes load_bytes(const void* from) {
    Bytes bytes;
    __builtin_memcpy(&bytes, from, sizeof bytes);
    return bytes;
}

/// The same number in each lane.
template <class Number>
RIPPLENOTCH_INLINED_WIDE Wide<Number> all(Number value) {
    return Wide<Number>{} + value;
}

}  // namespace ripplenotch
#endif
