// SPDX-License-Identifier: MIT
#include "core/process/memory.hpp"

#include <malloc.h>
#include <sys/mman.h>
#include <sys/resource.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <string>

#include "ripplenotch/core/files.hpp"

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
    // The large pages of x86-64, and of ARM with pages of 4 KiB; where they are larger the system refuses, or
    // takes its own.
    constexpr std::uintptr_t large = 2 * mebibyte;
    const auto from = reinterpret_cast<std::uintptr_t>(begin);
    const std::uintptr_t first = (from + large - 1) / large * large, end = (from + bytes) / large * large;
    if (first < end) ::madvise(reinterpret_cast<void*>(first), end - first, MADV_HUGEPAGE);
}

namespace {

using Bytes = std::optional<std::uint64_t>;

constexpr std::uint64_t kibibyte = 1024;

// "MemAvailable:   123 kB" in a list of such lines.
Bytes entry(const char* path, const std::string& name) {
    std::ifstream lines(path);
    std::string word;
    std::uint64_t kibibytes = 0;
    while (lines >> word) {
        if (word == name && lines >> kibibytes) return kibibytes * kibibyte;
    }
    return std::nullopt;
}

Bytes number_in(const char* path) {
    std::ifstream file(path);
    std::uint64_t number = 0;
    if (file >> number) return number;  // "max" is none
    return std::nullopt;
}

Bytes rest(Bytes limit, Bytes used) {
    if (!limit) return std::nullopt;
    return *limit - std::min(*limit, used.value_or(0));
}

Bytes address_space() {
    rlimit limit{};
    if (::getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return std::nullopt;
    return rest(limit.rlim_cur, entry("/proc/self/status", "VmSize:"));
}

}  // namespace

std::optional<std::uint64_t> memory_to_be_had() {
    Bytes least;
    for (const Bytes& one :
         {entry("/proc/meminfo", "MemAvailable:"), address_space(),
          rest(number_in("/sys/fs/cgroup/memory.max"), number_in("/sys/fs/cgroup/memory.current"))})
        if (one) least = std::min(least.value_or(*one), *one);
    return least;
}

}  // namespace ripplenotch
