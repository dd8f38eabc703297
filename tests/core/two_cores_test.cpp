// SPDX-License-Identifier: MIT
#include "core/process/two_cores.hpp"

#include <mutex>
#include <set>
#include <stdexcept>
#include <thread>
#include <vector>

#include "support/catch.hpp"

using namespace ripplenotch;

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

TEST_CASE("work stays on one core while another has the others, or where a thread costs more") {
    CHECK(threads_of(1) == 1);
    CHECK(threads_of(40, false) == 1);
    if (cores_here() > 1) CHECK(threads_of(40) == 2);
    const OneCore one;
    CHECK(cores_here() == 1);
    CHECK(threads_of(40) == 1);
}

TEST_CASE("what a part throws is thrown, and no part begins after it") {
    CHECK_THROWS_AS(on_two_cores(10,
                                 [](std::size_t i) {
                                     if (i == 3) throw std::runtime_error("no");
                                 }),
                    std::runtime_error);
    int done = 0;
    const OneCore one;
    CHECK_THROWS(on_two_cores(10, [&](std::size_t i) {
        if (i == 3) throw std::runtime_error("no");
        ++done;
    }));
    CHECK(done == 3);
}
