// SPDX-License-Identifier: MIT
#pragma once
// Internal to the log room: functions for AVX2, which not every processor has. Whether they may be called is
// asked of core/processor.hpp.

#if defined(__x86_64__) && defined(__GNUC__)
#define RIPPLENOTCH_X86_VECTORS 1
#include <immintrin.h>
#define WITH_AVX2 __attribute__((target("avx2")))
#endif
