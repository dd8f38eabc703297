// SPDX-License-Identifier: MIT
#pragma once
// Four doubles side by side, for loops that are worth it. Each lane is an ordinary double with ordinary
// rounding, and contraction is off for the whole build, so the bits do not depend on how lanes are held.
//
// Two ways from here. A kernel over a type of four lanes is built for two types, one register of AVX2 or two
// of what every x86-64 and ARM64 has, and its caller chooses. A function over Four alone is marked
// RIPPLENOTCH_FOR_AVX2_TOO, compiled twice, and the processor chooses at the start of the process.
//
// Everything is inlined and goes by reference: a value may not be handed to a function that has no register
// for it.

#include <cstddef>

namespace ripplenotch {

#define RIPPLENOTCH_INLINED inline __attribute__((always_inline))
#if defined(__x86_64__)
#define RIPPLENOTCH_TARGET_AVX2 __attribute__((target("avx2")))
#else
#define RIPPLENOTCH_TARGET_AVX2  // compiled, never called: has_avx2() is false (core/processor.hpp)
#endif
// Two copies of a function. Sanitizers are not there yet when it is decided which one runs.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
#define RIPPLENOTCH_FOR_AVX2_TOO __attribute__((target_clones("avx2", "default")))
#else
#define RIPPLENOTCH_FOR_AVX2_TOO
#endif

inline constexpr std::size_t lane_count = 4;

/// One register of AVX2, in functions of that target or in two copies.
using Four = double __attribute__((vector_size(32)));
using Two = double __attribute__((vector_size(16)));

/// Two registers of two.
struct TwoAndTwo {
    Two low, high;
};

/// The lanes of a comparison: all bits, or none.
using FourBits = long long __attribute__((vector_size(32)));
using TwoBits = long long __attribute__((vector_size(16)));

RIPPLENOTCH_INLINED TwoAndTwo operator+(const TwoAndTwo& a, const TwoAndTwo& b) {
    return {a.low + b.low, a.high + b.high};
}
RIPPLENOTCH_INLINED TwoAndTwo operator-(const TwoAndTwo& a, const TwoAndTwo& b) {
    return {a.low - b.low, a.high - b.high};
}
RIPPLENOTCH_INLINED TwoAndTwo operator*(const TwoAndTwo& a, const TwoAndTwo& b) {
    return {a.low * b.low, a.high * b.high};
}

// Copied as bytes, which is one instruction for any address of a double: clang aligns a vector type whatever
// is said.
RIPPLENOTCH_INLINED void load(Four& lanes, const double* from) {
    __builtin_memcpy(&lanes, from, sizeof lanes);
}
RIPPLENOTCH_INLINED void load(TwoAndTwo& lanes, const double* from) {
    __builtin_memcpy(&lanes.low, from, sizeof lanes.low);
    __builtin_memcpy(&lanes.high, from + 2, sizeof lanes.high);
}

RIPPLENOTCH_INLINED void store(double* to, const Four& lanes) { __builtin_memcpy(to, &lanes, sizeof lanes); }
RIPPLENOTCH_INLINED void store(double* to, const TwoAndTwo& lanes) {
    __builtin_memcpy(to, &lanes.low, sizeof lanes.low);
    __builtin_memcpy(to + 2, &lanes.high, sizeof lanes.high);
}

RIPPLENOTCH_INLINED double sum(const Four& lanes) { return (lanes[0] + lanes[1]) + (lanes[2] + lanes[3]); }

RIPPLENOTCH_INLINED void fill(Four& lanes, double value) { lanes = Four{value, value, value, value}; }
RIPPLENOTCH_INLINED void fill(TwoAndTwo& lanes, double value) {
    lanes = {Two{value, value}, Two{value, value}};
}

RIPPLENOTCH_INLINED void drop_signs(Four& lanes) {
    lanes = reinterpret_cast<Four>(reinterpret_cast<FourBits>(lanes) & 0x7FFF'FFFF'FFFF'FFFF);
}
RIPPLENOTCH_INLINED void drop_signs(TwoAndTwo& lanes) {
    lanes.low = reinterpret_cast<Two>(reinterpret_cast<TwoBits>(lanes.low) & 0x7FFF'FFFF'FFFF'FFFF);
    lanes.high = reinterpret_cast<Two>(reinterpret_cast<TwoBits>(lanes.high) & 0x7FFF'FFFF'FFFF'FFFF);
}

/// The four lanes of `from`, each spread over one of `to`.
RIPPLENOTCH_INLINED void spread(Four (&to)[4], const Four& from) {
    to[0] = __builtin_shufflevector(from, from, 0, 0, 0, 0);
    to[1] = __builtin_shufflevector(from, from, 1, 1, 1, 1);
    to[2] = __builtin_shufflevector(from, from, 2, 2, 2, 2);
    to[3] = __builtin_shufflevector(from, from, 3, 3, 3, 3);
}
RIPPLENOTCH_INLINED void spread(TwoAndTwo (&to)[4], const TwoAndTwo& from) {
    const Two a = __builtin_shufflevector(from.low, from.low, 0, 0);
    const Two b = __builtin_shufflevector(from.low, from.low, 1, 1);
    const Two c = __builtin_shufflevector(from.high, from.high, 0, 0);
    const Two d = __builtin_shufflevector(from.high, from.high, 1, 1);
    to[0] = {a, a};
    to[1] = {b, b};
    to[2] = {c, c};
    to[3] = {d, d};
}

}  // namespace ripplenotch
