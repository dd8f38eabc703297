// SPDX-License-Identifier: MIT
#pragma once
// Internal to the log room: functions for instruction sets that not every processor has. Which of them may be
// called is asked of core/processor.hpp.

#if defined(__x86_64__) && defined(__GNUC__)
#define RIPPLENOTCH_X86_VECTORS 1
// GCC 12 takes what its own header leaves open on purpose for a mistake (its bug 105593).
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#pragma GCC diagnostic ignored "-Wuninitialized"
#include <immintrin.h>
#pragma GCC diagnostic pop
#define WITH_AVX2 __attribute__((target("avx2")))
#define WITH_AVX512 \
    __attribute__((target("avx2,bmi,bmi2,lzcnt,popcnt,avx512f,avx512bw,avx512vl,avx512dq,avx512vbmi2")))
#endif
