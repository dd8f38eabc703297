// SPDX-License-Identifier: MIT
#include "filter/run/block_pipeline.hpp"

#include <atomic>
#include <chrono>
#include <mutex>
#include <set>
#include <stdexcept>
#include <thread>

#include "support/catch.hpp"

using namespace ripplenotch;

namespace {

constexpr std::size_t block_bytes = std::size_t{1} << 19;
constexpr std::size_t blocks = 40;  // 20 MiB: threads start behind the first four

/// Numbered blocks whose steps note what they saw.
struct Course {
    std::size_t fetched = 0;
    std::vector<std::size_t> filtered, put;
    std::atomic<int> on_their_way = 0, most_on_their_way = 0;
    std::mutex mutex;
    std::set<std::thread::id> workers;

    BlockSteps steps() {
        BlockSteps steps;
        steps.fetch = [this](BlockItem& item) {
            if (fetched == blocks) return false;
            item.block.bytes.assign(block_bytes, 'x');
            item.block.first_row = fetched++;
            most_on_their_way = std::max<int>(most_on_their_way, ++on_their_way);
            return true;
        };
        steps.parse = [this](BlockItem&) {
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
            const std::lock_guard lock(mutex);
            workers.insert(std::this_thread::get_id());
        };
        steps.filter = [this](BlockItem& item) { filtered.push_back(item.block.first_row); };
        steps.prepare = [](BlockItem& item) {
            // Every other block takes longer, so that those behind it come to the last door first.
            if (item.block.first_row % 2 == 0) std::this_thread::sleep_for(std::chrono::milliseconds(2));
        };
        steps.put = [this](BlockItem& item) {
            put.push_back(item.block.first_row);
            --on_their_way;
        };
        return steps;
    }
};

std::vector<std::size_t> first(std::size_t count) {
    std::vector<std::size_t> numbers(count);
    for (std::size_t i = 0; i < count; ++i) numbers[i] = i;
    return numbers;
}

}  // namespace

TEST_CASE("blocks are filtered and put in their order, and no more are on their way than there are threads") {
    for (const std::size_t threads : {1U, 2U, 3U, 8U}) {
        INFO(threads << " threads");
        Course course;
        run_blocks(course.steps(), threads);
        CHECK(course.filtered == first(blocks));
        CHECK(course.put == first(blocks));
        CHECK(course.most_on_their_way <= static_cast<int>(threads));
        CHECK(course.workers.size() <= threads);
        CHECK((threads == 1 || course.workers.size() > 1));
    }
}

TEST_CASE(
    "a failure comes after every block before it has been put, whichever step it is in and however many "
    "threads") {
    const std::size_t failing = 25;
    for (const std::size_t threads : {1U, 2U, 5U}) {
        for (int which = 0; which < 4; ++which) {
            INFO(threads << " threads, step " << which);
            Course course;
            BlockSteps steps = course.steps();
            const auto fails = [&](const std::function<void(BlockItem&)>& step) {
                return [&, step](BlockItem& item) {
                    // A later block's failure comes earlier in time and must not be told instead.
                    if (item.block.first_row == failing + 1) throw std::runtime_error("later");
                    if (item.block.first_row == failing) {
                        std::this_thread::sleep_for(std::chrono::milliseconds(5));
                        throw std::runtime_error("first");
                    }
                    step(item);
                };
            };
            std::function<void(BlockItem&)>* const chosen[] = {&steps.parse, &steps.filter, &steps.prepare,
                                                               &steps.put};
            *chosen[which] = fails(*chosen[which]);
            CHECK_THROWS_WITH(run_blocks(steps, threads), "first");
            CHECK(course.put == first(failing));
        }
    }
}

TEST_CASE("a source that breaks off is told after everything that came before has been put") {
    for (const std::size_t threads : {1U, 3U}) {
        Course course;
        BlockSteps steps = course.steps();
        steps.fetch = [&course, fetch = steps.fetch](BlockItem& item) {
            if (course.fetched == 20) throw std::runtime_error("broken pipe");
            return fetch(item);
        };
        CHECK_THROWS_WITH(run_blocks(steps, threads), "broken pipe");
        CHECK(course.put == first(20));
        CHECK(course.fetched == 20);
    }
}
