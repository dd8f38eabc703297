// SPDX-License-Identifier: MIT
#include "filter/block_pipeline.hpp"

#include <condition_variable>
#include <limits>
#include <mutex>
#include <new>
#include <optional>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

namespace ripplenotch {
namespace {

constexpr std::size_t short_log_bytes = std::size_t{4} << 20;  // done before threads would have started

/// Lets block after block through, one at a time, each when its turn has come.
class Door {
  public:
    template <typename Step>
    void pass(std::size_t turn, const Step& step) {
        std::unique_lock lock(mutex_);
        moved_.wait(lock, [&] { return next_ == turn; });
        lock.unlock();
        step();
        lock.lock();
        ++next_;
        moved_.notify_all();
    }

  private:
    std::mutex mutex_;
    std::condition_variable moved_;
    std::size_t next_ = 0;
};

/// State shared by the workers. Each takes a block and does all its steps; only at the entry to a step does
/// it wait for others, so no more blocks are in progress than there are workers.
class Convoy {
  public:
    explicit Convoy(const BlockSteps& steps) : steps_(steps) {}

    void work(BlockItem item = {}) {
        while (const auto turn = fetch(item)) {
            if (!item.accepted) attempt(item, steps_.parse);
            filter_door_.pass(*turn, [&] {
                // After a failed block the filter has no state to continue from.
                if (!filter_failed_) attempt(item, steps_.filter);
                filter_failed_ = filter_failed_ || item.error;
            });
            attempt(item, steps_.prepare);
            put_door_.pass(*turn, [&] {
                if (!failure_) attempt(item, steps_.put);
                if (!failure_ && item.error) fail(item.error);
            });
        }
    }

    [[nodiscard]] const std::exception_ptr& failure() const { return failure_; }

  private:
    /// Does one step of a block that has not failed; keeps the failure for the turn of the last step.
    template <typename Step>
    static void attempt(BlockItem& item, const Step& step) {
        if (item.error) return;
        try {
            step(item);
        } catch (...) {
            item.error = std::current_exception();
        }
    }

    /// The block's turn, or nothing when there is no block left or something has failed.
    std::optional<std::size_t> fetch(BlockItem& item) {
        const std::lock_guard lock(fetch_mutex_);
        if (over_) return std::nullopt;
        renew(item);
        bool more = true;
        attempt(item, [&](BlockItem& one) { more = steps_.fetch(one); });
        over_ = !more || item.error;
        if (!more) return std::nullopt;
        return fetched_++;
    }

    void fail(const std::exception_ptr& error) {
        failure_ = error;
        const std::lock_guard lock(fetch_mutex_);
        over_ = true;
    }

  public:
    static void renew(BlockItem& item) {
        item.accepted = false;
        item.error = nullptr;
    }

  private:
    const BlockSteps& steps_;
    std::mutex fetch_mutex_;
    bool over_ = false;        ///< behind fetch_mutex_, like:
    std::size_t fetched_ = 0;  ///< the next block's turn
    Door filter_door_, put_door_;
    bool filter_failed_ = false;  ///< behind filter_door_
    std::exception_ptr failure_;  ///< behind put_door_
};

/// As many as the system gives: the caller's own thread does the remaining work.
void start_helpers(Convoy& convoy, std::size_t count, std::vector<std::jthread>& helpers) {
    const auto help = [&convoy] {
        std::optional<BlockItem> item;
        try {
            item.emplace();
        } catch (const std::bad_alloc&) {
            return;
        }
        convoy.work(std::move(*item));
    };
    helpers.reserve(count);
    try {
        while (helpers.size() < count) helpers.emplace_back(help);
    } catch (const std::system_error&) {  // no thread to be had
    }
}

/// Runs blocks one after another until there are none left (true) or `most_bytes` have passed.
bool run_alone(const BlockSteps& steps, std::size_t most_bytes, BlockItem& item) {
    for (std::size_t bytes = 0; bytes < most_bytes; Convoy::renew(item)) {
        if (!steps.fetch(item)) return true;
        if (!item.accepted) steps.parse(item);
        bytes += item.block.bytes.size() + sizeof(double) * item.block.size();
        steps.filter(item);
        steps.prepare(item);
        steps.put(item);
    }
    return false;
}

}  // namespace

void run_blocks(const BlockSteps& steps, std::size_t threads) {
    const std::size_t alone = threads < 2 ? std::numeric_limits<std::size_t>::max() : short_log_bytes;
    BlockItem item;
    if (run_alone(steps, alone, item)) return;
    Convoy convoy(steps);
    {
        std::vector<std::jthread> helpers;
        start_helpers(convoy, threads - 1, helpers);
        convoy.work(std::move(item));
    }
    if (convoy.failure()) std::rethrow_exception(convoy.failure());
}

}  // namespace ripplenotch
