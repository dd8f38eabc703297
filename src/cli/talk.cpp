// SPDX-License-Identifier: MIT
#include "cli/talk.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <condition_variable>
#include <cstdlib>
#include <ctime>
#include <mutex>
#include <string>
#include <string_view>
#include <system_error>
#include <thread>

#include "ripplenotch/core/files.hpp"
#include "ripplenotch/core/progress.hpp"
#include "ripplenotch/core/visible_text.hpp"

namespace ripplenotch {

std::string text_table(const TextRows& cells, std::string_view alignment) {
    TextRows rows = cells;
    for (auto& row : rows)
        for (std::string& cell : row) cell = visible_text(cell);
    std::vector<std::size_t> widths;
    for (const auto& row : rows) {
        widths.resize(std::max(widths.size(), row.size()));
        for (std::size_t c = 0; c < row.size(); ++c) widths[c] = std::max(widths[c], row[c].size());
    }
    std::string text;
    for (const auto& row : rows) {
        std::string line;
        for (std::size_t c = 0; c < row.size(); ++c) {
            if (c > 0) line += "  ";
            const bool left = alignment[std::min(c, alignment.size() - 1)] == 'l';
            line +=
                left ? fmt::format("{:<{}}", row[c], widths[c]) : fmt::format("{:>{}}", row[c], widths[c]);
        }
        line.erase(line.find_last_not_of(' ') + 1);
        text += line + "\n";
    }
    return text;
}

namespace {

using SteadyClock = std::chrono::steady_clock;
constexpr auto patience = std::chrono::seconds(1);
constexpr auto tick = std::chrono::milliseconds(100);

bool can_show(const std::vector<std::string>& words) {
    const auto says = [&words](const char* word) {
        return std::find(words.begin(), words.end(), word) != words.end();
    };
    const char* const terminal = std::getenv("TERM");
    return ::isatty(STDERR_FILENO) == 1 && !says("-q") && !says("--quiet") &&
           (terminal == nullptr || std::string_view(terminal) != "dumb");
}

int columns() {
    winsize size{};
    const bool known = ::ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 1;
    return known ? size.ws_col - 1 : 79;
}

void put_at_once(std::string_view text) {
    static_cast<void>(!::write(STDERR_FILENO, text.data(), text.size()));
}

}  // namespace

struct ProgressBar::Painter {
    std::string command;
    std::mutex mutex;
    std::condition_variable ending;
    bool ended = false, on_screen = false;
    std::thread thread;

    static Painter* at_work;

    explicit Painter(std::string name) : command(std::move(name)) {
        at_work = this;
        Progress::current().on_step_aside([] { at_work->hide(); });
        thread = std::thread([this] { paint(); });
    }
    ~Painter() {
        Progress::current().on_step_aside(nullptr);
        {
            const std::lock_guard lock(mutex);
            ended = true;
        }
        ending.notify_all();
        thread.join();
        hide();
        at_work = nullptr;
    }
    Painter(const Painter&) = delete;
    Painter& operator=(const Painter&) = delete;

    void hide() {
        const std::lock_guard lock(mutex);
        if (on_screen) put_at_once("\r\x1b[K");
        on_screen = false;
    }

    void paint() {
        const auto start = SteadyClock::now();
        auto stage_start = start;
        unsigned stage = 0;
        std::unique_lock lock(mutex);
        while (!ending.wait_for(lock, tick, [this] { return ended; })) {
            const Progress::State state = Progress::current().state();
            if (state.stage != stage) {
                stage = state.stage;
                stage_start = SteadyClock::now();
            }
            if (stage == 0 || SteadyClock::now() - start < patience) continue;
            put_at_once("\r" + progress_line(command, state, SteadyClock::now() - stage_start, columns()) +
                        "\x1b[K");
            on_screen = true;
        }
    }
};

ProgressBar::Painter* ProgressBar::Painter::at_work = nullptr;

ProgressBar::ProgressBar(const std::vector<std::string>& words) {
    if (!can_show(words)) return;
    try {
        painter_ = std::make_unique<Painter>(words.empty() ? "" : words.front());
    } catch (const std::system_error&) {  // no thread to be had: no bar
        Progress::current().on_step_aside(nullptr);
    }
}

ProgressBar::~ProgressBar() = default;

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

std::string* captured = nullptr;  ///< capture_talk

void put(std::string_view bytes) {
    if (captured != nullptr) {
        *captured += bytes;
        return;
    }
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

// Lines as people may see them: everything but their ends made visible.
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

}  // namespace

void capture_talk(std::string* text) noexcept { captured = text; }

void talk(std::string_view line) { put(visible_text(line) + "\n"); }

void talk_lines(std::string_view lines) { put(visible_lines(lines)); }

std::optional<std::size_t> terminal_columns() {
    if (::isatty(STDOUT_FILENO) != 1) return std::nullopt;
    winsize size{};
    const bool known = ::ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0;
    return known ? size.ws_col : std::size_t{80};
}

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
