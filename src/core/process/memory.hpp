// SPDX-License-Identifier: MIT
#pragma once
#include <cstddef>

namespace ripplenotch {

// Internal: how this process asks the system for memory. A page that is touched for the first time costs a
// fault, which in small pages takes longer than what is then written there.

/// What is freed is kept for what comes next, in one heap for all threads. Of the program, not of the
/// library: once, before any thread.
void keep_what_is_freed();

/// What the heap takes next, up to 31 MiB, it takes in large pages, where the system has them. For work on a
/// long log: a short one would hold more than it needs. Says nothing where it fails.
void grow_heap_in_large_pages();

/// The whole large pages among `bytes` from `begin` on come as such, where the system has them.
void ask_for_large_pages(void* begin, std::size_t bytes);

}  // namespace ripplenotch
