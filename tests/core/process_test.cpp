// SPDX-License-Identifier: MIT
// What is told while work goes on, and work on two cores.
#include <mutex>
#include <set>
#include <stdexcept>
#include <thread>
#include <vector>

#include "core/process/two_cores.hpp"
#include "ripplenotch/core/progress.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using std::chrono::duration;

TEST_CASE("progress shows share, rate and the time that is left") {
    const Progress::State state{"reading", "B", 45'000'000, 100'000'000, 1};
    CHECK(progress_line("filter", state, duration<double>(3.0), 79) ==
          "filter: reading [=============>                ]   45 %  15.0 MB/s  4 s left");
}

TEST_CASE("without a total it shows rate and the time spent") {
    CHECK(progress_line("filter", {"reading", "B", 1500, 0, 1}, duration<double>(2.0), 79) ==
          "filter: reading  750 B/s  2 s");
    CHECK(progress_line("identify", {"looking for lines", "", 0, 0, 1}, duration<double>(200.0), 79) ==
          "identify: looking for lines  3:20 min");
}

TEST_CASE("the bar is empty at first, full at the end, and never beyond") {
    const auto line = [](std::uint64_t done) {
        return progress_line("x", {"y", "rows", done, 1000, 1}, duration<double>(1.0), 60);
    };
    CHECK(line(0).find("[>      ") != std::string::npos);
    CHECK(line(0).find("left") == std::string::npos);
    CHECK(line(1000).find('>') == std::string::npos);
    CHECK(line(1000).find("100 %") != std::string::npos);
    CHECK(line(5000).find("100 %") != std::string::npos);
    CHECK(line(999).find(" 99 %") != std::string::npos);
}

TEST_CASE("the line fits the terminal, however narrow") {
    for (int columns = 1; columns <= 200; ++columns) {
        for (const std::uint64_t done : {0ULL, 1ULL, 123'456'789ULL, 10'000'000'000ULL}) {
            for (const std::uint64_t total : {0ULL, 10'000'000'000ULL}) {
                const Progress::State state{"reading", "B", done, total, 1};
                CHECK(progress_line("filter", state, duration<double>(5000.0), columns).size() <=
                      static_cast<std::size_t>(columns));
            }
        }
    }
}

TEST_CASE("a stage that begins starts from nothing") {
    Progress progress;
    progress.begin("reading", "B", 100);
    progress.add(60);
    progress.add(10);
    CHECK(progress.state().done == 70);
    progress.begin("looking", "joints", 3);
    CHECK(progress.state().done == 0);
    CHECK(progress.state().total == 3);
    CHECK(progress.state().stage == 2);
}

TEST_CASE("nothing steps aside where nothing is shown") {
    Progress progress;
    progress.step_aside();
    static int asked;
    asked = 0;
    progress.on_step_aside([] { ++asked; });
    progress.step_aside();
    CHECK(asked == 1);
}

namespace {

// How many threads had a part in the work, which waits a while for another.
std::size_t threads_of(std::size_t count, bool worth_it = true) {
    std::mutex mutex;
    std::set<std::thread::id> threads;
    on_two_cores(
        count,
        [&](std::size_t) {
            std::this_thread::sleep_for(std::chrono::milliseconds(5));
            const std::lock_guard lock(mutex);
            threads.insert(std::this_thread::get_id());
        },
        worth_it);
    return threads.size();
}

}  // namespace

TEST_CASE("every part of the work is done once, on however many cores") {
    for (const bool worth_it : {false, true}) {
        std::vector<int> done(1000);
        on_two_cores(
            done.size(), [&](std::size_t i) { ++done[i]; }, worth_it);
        CHECK(done == std::vector<int>(1000, 1));
    }
}

TEST_CASE("work stays on one core where a thread costs more") {
    CHECK(threads_of(1) == 1);
    CHECK(threads_of(40, false) == 1);
    if (cores_here() > 1) CHECK(threads_of(40) == 2);
}

TEST_CASE("what a part throws is thrown, and no part begins after it") {
    CHECK_THROWS_AS(on_two_cores(10,
                                 [](std::size_t i) {
                                     if (i == 3) throw std::runtime_error("no");
                                 }),
                    std::runtime_error);
    int done = 0;
    const auto work = [&](std::size_t i) {
        if (i == 3) throw std::runtime_error("no");
        ++done;
    };
    CHECK_THROWS(on_two_cores(10, work, false));
    CHECK(done == 3);
}
