// SPDX-License-Identifier: MIT
#include "core/process/heap.hpp"

#include <malloc.h>
#include <sys/mman.h>

#include <cstdint>
#include <cstdlib>

namespace ripplenotch {
namespace {

constexpr std::size_t mebibyte = std::size_t{1} << 20;
// The most that glibc takes; what is larger is mapped by itself.
constexpr std::size_t most_of_heap = 32 * mebibyte;

}  // namespace

void keep_what_is_freed() {
#ifdef __GLIBC__
    // What one thread has freed another may take: with a heap each `identify` goes beyond its 64 MiB.
    ::mallopt(M_ARENA_MAX, 1);
    // What is freed is wanted again at once: to give pages back and to have them zeroed anew took an eighth
    // of the time of `identify`.
    ::mallopt(M_MMAP_THRESHOLD, most_of_heap);
    ::mallopt(M_TRIM_THRESHOLD, 2 * most_of_heap);
#endif
}

void grow_heap_in_large_pages() {
    const std::size_t bytes = most_of_heap - mebibyte;
    void* const block = std::malloc(bytes);
    if (block == nullptr) return;
    ask_for_large_pages(block, bytes);
    std::free(block);
}

void ask_for_large_pages(void* begin, std::size_t bytes) {
    // Of x86-64, and of ARM with pages of 4 KiB; where they are larger the system refuses, or takes its own.
    constexpr std::uintptr_t large = 2 * mebibyte;
    const auto from = reinterpret_cast<std::uintptr_t>(begin);
    const std::uintptr_t first = (from + large - 1) / large * large, end = (from + bytes) / large * large;
    if (first < end) ::madvise(reinterpret_cast<void*>(first), end - first, MADV_HUGEPAGE);
}

}  // namespace ripplenotch
