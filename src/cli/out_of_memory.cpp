// SPDX-License-Identifier: MIT
// Memory that is not to be had, wherever it is asked for: one exception, which main() tells once.

#include "cli/out_of_memory.hpp"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <new>

#include "core/files/byte_sink.hpp"
#include "core/process/sanitized.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/progress.hpp"

namespace ripplenotch {
namespace {

std::atomic<std::size_t> refused = 0;

constexpr double mebibyte = 1024.0 * 1024.0, kibibytes = 1024.0;

double peak_mebibytes() {
    rusage usage{};
    ::getrusage(RUSAGE_SELF, &usage);
    return static_cast<double>(usage.ru_maxrss) / kibibytes;
}

std::terminate_handler before = nullptr;

[[noreturn]] void say_and_end() noexcept {
    try {
        if (const auto error = std::current_exception()) std::rethrow_exception(error);
    } catch (const std::bad_alloc&) {
        say_out_of_memory("");
        remove_unfinished_files();
        ::_exit(static_cast<int>(ExitCode::memory));
    } catch (...) {
    }
    if (before != nullptr) before();
    std::abort();
}

}  // namespace

void end_where_nothing_may_throw() { before = std::set_terminate(say_and_end); }

void say_out_of_memory(std::string_view command) noexcept {
    std::array<char, 64> wanted{};
    if (const std::size_t size = refused; size > 0)
        std::snprintf(wanted.data(), wanted.size(), ": %.3g MiB more are not available, with",
                      static_cast<double>(size) / mebibyte);
    else
        std::snprintf(wanted.data(), wanted.size(), ", with");
    std::array<char, 512> message{};
    const int size =
        std::snprintf(message.data(), message.size(),
                      "%.*s%s%.*s: out of memory%s %.3g MiB in use; take a part of the log with --from and "
                      "--to, or a spectrum in "
                      "pieces with --segment (info, identify, filter need no more for a longer log)\n",
                      static_cast<int>(tool_name.size()), tool_name.data(), command.empty() ? "" : " ",
                      static_cast<int>(command.size()), command.data(), wanted.data(), peak_mebibytes());
    if (size > 0)
        static_cast<void>(!::write(STDERR_FILENO, message.data(),
                                   std::min(static_cast<std::size_t>(size), message.size() - 1)));
}

}  // namespace ripplenotch

// Sanitizers have allocators of their own.
#if !defined(RIPPLENOTCH_SANITIZED)

// As the standard library does it, and remembers how much could not be had.
void* operator new(std::size_t size) {
    if (void* const memory = std::malloc(size > 0 ? size : 1))
        return memory;  // NOLINT: this is the allocator
    ripplenotch::refused = size;
    throw std::bad_alloc();
}
void operator delete(void* memory) noexcept { std::free(memory); }                        // NOLINT
void operator delete(void* memory, std::size_t /*size*/) noexcept { std::free(memory); }  // NOLINT

#endif

// What FFTW calls where it finds itself in the wrong, and also where memory is not to be had; its own prints
// a line and aborts. It holds nothing then that another transform would miss.
extern "C" void fftw_assertion_failed(const char* what, int line, const char* file);
extern "C" void fftw_assertion_failed(const char* what, int line, const char* file) {
    if (std::strcmp(what, "p") == 0) throw std::bad_alloc();
    static_cast<void>(std::fprintf(stderr, "fftw: %s:%d: assertion failed: %s\n", file, line, what));
    std::abort();
}
