// SPDX-License-Identifier: MIT
#include "core/processor.hpp"

namespace ripplenotch {

bool has_avx2() {
#if defined(__x86_64__) && defined(__GNUC__)
    static const bool has = __builtin_cpu_supports("avx2") != 0;
    return has;
#else
    return false;
#endif
}

}  // namespace ripplenotch
