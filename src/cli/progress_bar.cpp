// SPDX-License-Identifier: MIT
#include "cli/progress_bar.hpp"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <cstdlib>
#include <mutex>
#include <string_view>
#include <system_error>
#include <thread>

#include "ripplenotch/core/progress.hpp"

namespace ripplenotch {
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

}  // namespace ripplenotch
