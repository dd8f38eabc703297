// SPDX-License-Identifier: MIT
// Runs the command line, and turns every exception into one message and an exit code.

#include <fmt/format.h>

#include <csignal>
#include <exception>
#include <new>

#include "cli/run.hpp"
#include "cli/talk.hpp"
#include "core/files/byte_sink.hpp"

namespace ripplenotch {
namespace {

ExitCode run(const CommandWords& words) {
    std::string running;
    try {
        return run_command(words, running);
    } catch (const Error& error) {
        return complain(error.code(), running, error.what());
    } catch (const std::bad_alloc&) {
        return complain(ExitCode::memory, running,
                        "out of memory; take a part of the log with --from and --to");
    } catch (const std::exception& error) {
        return complain(ExitCode::internal, running, fmt::format("internal fault: {}", error.what()));
    }
}

}  // namespace
}  // namespace ripplenotch

int main(int argc, char** argv) {
    // "| head" must end us quietly even where the parent process has SIGPIPE ignored.
    std::signal(SIGPIPE, SIG_DFL);
    ripplenotch::hold_closed_streams();
    ripplenotch::remove_unfinished_files_on_signals();
    return static_cast<int>(ripplenotch::run({argv + 1, argv + argc}));
}
