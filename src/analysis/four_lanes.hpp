// SPDX-License-Identifier: MIT
#pragma once
// Four doubles side by side, for loops that are worth it. Contraction is off for the whole build, so the bits
// are the same whether four lanes are one register of AVX2 or two of what every processor has.

#include <cstddef>

// Two copies of a function; the processor says at the start of the process which one runs. The address
// sanitizer is not there yet when that is decided.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__)
#define RIPPLENOTCH_FOR_AVX2_TOO __attribute__((target_clones("avx2", "default")))
#else
#define RIPPLENOTCH_FOR_AVX2_TOO
#endif

namespace ripplenotch::four_lanes {

inline constexpr std::size_t lanes = 4;
using Four = double __attribute__((vector_size(lanes * sizeof(double))));
using FourInMemory = double __attribute__((vector_size(lanes * sizeof(double)), aligned(8), may_alias));

// By reference and always inlined: four lanes may not be handed to a function that has no register for them.
inline __attribute__((always_inline)) void load(Four& four, const double* from) {
    four = *reinterpret_cast<const FourInMemory*>(from);
}
inline __attribute__((always_inline)) void store(double* to, const Four& four) {
    *reinterpret_cast<FourInMemory*>(to) = four;
}
inline __attribute__((always_inline)) double sum(const Four& four) {
    return (four[0] + four[1]) + (four[2] + four[3]);
}

}  // namespace ripplenotch::four_lanes
