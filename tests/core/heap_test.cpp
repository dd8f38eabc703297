// SPDX-License-Identifier: MIT
#include "core/process/memory.hpp"

#include <sys/mman.h>

#include <cstdint>
#include <cstdio>
#include <fstream>
#include <sstream>
#include <string>

#include "support/catch.hpp"

using namespace ripplenotch;

namespace {

// "VmFlags: rd wr mr mw me ac hg" of the mapping that holds an address; "hg" is what was asked for.
bool asked_for_large_pages(const void* address) {
    const auto at = reinterpret_cast<std::uintptr_t>(address);
    std::ifstream lines("/proc/self/smaps");
    bool here = false;
    for (std::string line; std::getline(lines, line);) {
        unsigned long begin = 0, end = 0;
        if (std::sscanf(line.c_str(), "%lx-%lx ", &begin, &end) == 2) here = begin <= at && at < end;
        if (here && line.starts_with("VmFlags:")) return (line + " ").find(" hg ") != std::string::npos;
    }
    return false;
}

bool system_has_large_pages() {
    return std::ifstream("/sys/kernel/mm/transparent_hugepage/enabled").good() &&
           std::ifstream("/proc/self/smaps").good();
}

}  // namespace

TEST_CASE("large pages are asked for within what was given, never beside it") {
    if (!system_has_large_pages()) return SUCCEED("this system has no large pages");
    constexpr std::size_t page = 4096, large = std::size_t{2} << 20, bytes = 3 * large;
    void* const mapped =
        ::mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    REQUIRE(mapped != MAP_FAILED);
    auto* const begin = static_cast<char*>(mapped);
    char* const first = begin + (large - reinterpret_cast<std::uintptr_t>(begin) % large) % large;
    ask_for_large_pages(first + page, large - page);  // no large page is whole in it
    CHECK_FALSE(asked_for_large_pages(first));
    ask_for_large_pages(first, large + page);  // one is
    CHECK(asked_for_large_pages(first));
    CHECK(asked_for_large_pages(first + large - page));
    CHECK_FALSE(asked_for_large_pages(first + large));
    ::munmap(mapped, bytes);
}
