// SPDX-License-Identifier: MIT
#include "core/vectors/lanes.hpp"

#include <atomic>
#include <cstdlib>
#include <string_view>

// glibc's own view of the processor, where there is one: it heeds GLIBC_TUNABLES, so that a test can have the
// whole program do without AVX2. clang does not take its header in strict C++.
#if defined(__x86_64__) && !defined(__clang__) && __has_include(<sys/platform/x86.h>)
#include <sys/platform/x86.h>
#define RIPPLENOTCH_ASKS_GLIBC 1
#endif

namespace ripplenotch {
namespace {

bool processor_has_them() {
#if defined(RIPPLENOTCH_ASKS_GLIBC)
    return CPU_FEATURE_ACTIVE(AVX2);
#elif defined(__x86_64__) && defined(__GNUC__)
    return __builtin_cpu_supports("avx2") != 0;
#elif defined(__aarch64__) && defined(__GNUC__)
    return true;
#else
    return false;
#endif
}

// For doubters, who compare a result with and without; main() refuses other words.
bool switched_off() {
    const char* const asked = std::getenv("RIPPLENOTCH_VECTORS");
    return asked != nullptr && std::string_view(asked) == "none";
}

std::atomic<bool>& wide() {
    static std::atomic<bool> answer = processor_has_them() && !switched_off();
    return answer;
}

}  // namespace

bool wide_vectors() noexcept { return wide().load(std::memory_order_relaxed); }

NarrowVectors::NarrowVectors() noexcept : before_(wide().exchange(false)) {}
NarrowVectors::~NarrowVectors() { wide() = before_; }

}  // namespace ripplenotch
