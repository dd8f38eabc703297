// SPDX-License-Identifier: MIT
// Runs the command line, and turns every exception into one message and an exit code.

#include <fmt/format.h>

#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <new>
#include <string_view>

#include "cli/command.hpp"
#include "cli/talk.hpp"
#include "core/files/byte_sink.hpp"

namespace ripplenotch {
namespace {

// Written as it is: where memory is not to be had, none is left to compose a message.
void say_out_of_memory() noexcept {
    constexpr std::string_view message =
        "ripplenotch: out of memory; take a part of the log with --from and --to\n";
    static_cast<void>(!::write(STDERR_FILENO, message.data(), message.size()));
}

// Memory may also end where nothing may throw, or while an error is reported.
[[noreturn]] void end() noexcept {
    try {
        if (const auto error = std::current_exception()) std::rethrow_exception(error);
    } catch (const std::bad_alloc&) {
        say_out_of_memory();
        remove_unfinished_files();
        ::_exit(static_cast<int>(ExitCode::memory));
    } catch (...) {
    }
    std::abort();
}

ExitCode run(const CommandWords& words) {
    std::string running;
    try {
        return run_command(words, running);
    } catch (const Error& error) {
        return complain(error.code(), running, error.what());
    } catch (const std::bad_alloc&) {
        say_out_of_memory();
        return ExitCode::memory;
    } catch (const std::exception& error) {
        return complain(ExitCode::internal, running, fmt::format("internal fault: {}", error.what()));
    }
}

}  // namespace
}  // namespace ripplenotch

// What FFTW calls where it finds itself in the wrong, and also where memory is not to be had; its own prints
// a line and aborts.
extern "C" void fftw_assertion_failed(const char* what, int line, const char* file);
extern "C" void fftw_assertion_failed(const char* what, int line, const char* file) {
    if (std::strcmp(what, "p") == 0) throw std::bad_alloc();
    static_cast<void>(std::fprintf(stderr, "fftw: %s:%d: assertion failed: %s\n", file, line, what));
    std::abort();
}

int main(int argc, char** argv) {
    // "| head" must end us quietly even where the parent process has SIGPIPE ignored.
    std::signal(SIGPIPE, SIG_DFL);
    ripplenotch::hold_closed_streams();
    ripplenotch::remove_unfinished_files_on_signals();
    std::set_terminate(ripplenotch::end);
    return static_cast<int>(ripplenotch::run({argv + 1, argv + argc}));
}
