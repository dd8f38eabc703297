// SPDX-License-Identifier: MIT
#include "cli/talk.hpp"

#include <fcntl.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <ctime>

#include "ripplenotch/core/progress.hpp"
#include "ripplenotch/core/visible_text.hpp"

namespace ripplenotch {
namespace {

// A reader of standard error that has gone away ends nothing: the signal is held back while it is written to.
class NoBrokenPipe {
  public:
    NoBrokenPipe() {
        sigemptyset(&pipe_);
        sigaddset(&pipe_, SIGPIPE);
        pthread_sigmask(SIG_BLOCK, &pipe_, &before_);
    }
    ~NoBrokenPipe() {
        if (broken && sigismember(&before_, SIGPIPE) == 0) {
            const timespec at_once{};
            while (sigtimedwait(&pipe_, nullptr, &at_once) == -1 && errno == EINTR) {
            }
        }
        pthread_sigmask(SIG_SETMASK, &before_, nullptr);
    }
    NoBrokenPipe(const NoBrokenPipe&) = delete;
    NoBrokenPipe& operator=(const NoBrokenPipe&) = delete;

    bool broken = false;

  private:
    sigset_t pipe_{}, before_{};
};

void put(std::string_view bytes) {
    Progress::current().step_aside();
    NoBrokenPipe guard;
    while (!bytes.empty()) {
        const ssize_t done = ::write(STDERR_FILENO, bytes.data(), bytes.size());
        if (done > 0) {
            bytes.remove_prefix(static_cast<std::size_t>(done));
        } else if (done == 0 || errno != EINTR) {
            guard.broken = done < 0 && errno == EPIPE;
            return;
        }
    }
}

bool all_plain(std::string_view lines) {
    return std::all_of(lines.begin(), lines.end(),
                       [](char c) { return c == '\n' || (c >= 0x20 && c < 0x7F); });
}

}  // namespace

std::string visible_lines(std::string_view lines) {
    std::string shown;
    while (!lines.empty()) {
        const std::size_t end = lines.find('\n');
        shown += visible_text(lines.substr(0, end));
        if (end == std::string_view::npos) break;
        shown += '\n';
        lines.remove_prefix(end + 1);
    }
    return shown;
}

void talk(std::string_view line) { put(visible_text(line) + "\n"); }

void talk_lines(std::string_view lines) { put(visible_lines(lines)); }

void write_text(const std::string& path, std::string_view lines, ByteSink::Overwrite overwrite) {
    if (all_plain(lines)) {
        write_all(path, lines, overwrite);  // a spectrum may be long
    } else {
        write_all(path, visible_lines(lines), overwrite);
    }
}

void hold_closed_streams() {
    // Opened the wrong way round, so that using it is an error as it is on a closed one.
    for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
        if (::fcntl(stream, F_GETFD) != -1 || errno != EBADF) continue;
        static_cast<void>(::open("/dev/null", stream == STDIN_FILENO ? O_WRONLY : O_RDONLY));
    }
}

}  // namespace ripplenotch
