// SPDX-License-Identifier: MIT
#include "ripplenotch/core/memory.hpp"

#include <sys/resource.h>

#include <algorithm>
#include <fstream>
#include <string>

namespace ripplenotch {
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
