// SPDX-License-Identifier: MIT
#pragma once
// Internal: RIPPLENOTCH_SANITIZED is defined where a sanitizer has an allocator and handlers of signals of
// its own.

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define RIPPLENOTCH_SANITIZED 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer) || __has_feature(memory_sanitizer)
#define RIPPLENOTCH_SANITIZED 1
#endif
#endif
