// SPDX-License-Identifier: MIT
#include "filter/block_pipeline.hpp"

#include <tbb/parallel_pipeline.h>
#include <tbb/task_arena.h>

#include <limits>

namespace ripplenotch {
namespace {

constexpr std::size_t blocks_a_thread = 2;
constexpr std::size_t short_log_bytes = std::size_t{4} << 20;  // done before threads would have started

/// Does one step of a block that has not failed; keeps the failure for put's turn.
template <typename Step>
void attempt(BlockItem& item, const Step& step) {
    if (item.error) return;
    try {
        step(item);
    } catch (...) {
        item.error = std::current_exception();
    }
}

void renew(BlockItem& item) {
    item.accepted = false;
    item.error = nullptr;
}

/// Runs blocks one after another until there are none left (true) or `most_bytes` have passed.
bool run_alone(const BlockSteps& steps, std::size_t most_bytes) {
    BlockItem item;
    for (std::size_t bytes = 0; bytes < most_bytes; renew(item)) {
        if (!steps.fetch(item)) return true;
        bytes += item.block.bytes.size();
        if (!item.accepted) steps.parse(item);
        steps.filter(item);
        steps.prepare(item);
        steps.put(item);
    }
    return false;
}

}  // namespace

void run_blocks(const BlockSteps& steps, std::size_t threads) {
    const std::size_t alone = threads < 2 ? std::numeric_limits<std::size_t>::max() : short_log_bytes;
    if (run_alone(steps, alone)) return;
    // At most so many blocks are on their way, so a slot is free again when its turn comes round.
    std::vector<BlockItem> slots(blocks_a_thread * threads);
    std::size_t fetched = 0;
    bool fetch_failed = false, filter_failed = false;
    const auto fetch = [&](tbb::flow_control& flow) -> BlockItem* {
        BlockItem& item = slots[fetched++ % slots.size()];
        renew(item);
        bool more = !fetch_failed;
        attempt(item, [&](BlockItem& one) { more = more && steps.fetch(one); });
        fetch_failed = item.error != nullptr;
        if (!more) flow.stop();
        return &item;
    };
    const auto parse = [&](BlockItem* item) {
        if (!item->accepted) attempt(*item, steps.parse);
        return item;
    };
    const auto filter = [&](BlockItem* item) {
        // What comes after a failed block has no past to go on from.
        if (!filter_failed) attempt(*item, steps.filter);
        filter_failed = filter_failed || item->error;
        return item;
    };
    const auto prepare = [&](BlockItem* item) {
        attempt(*item, steps.prepare);
        return item;
    };
    const auto put = [&](BlockItem* item) {
        if (item->error) std::rethrow_exception(item->error);
        steps.put(*item);
    };
    using tbb::filter_mode;
    tbb::task_arena arena(static_cast<int>(threads));
    arena.execute([&] {
        tbb::parallel_pipeline(
            slots.size(), tbb::make_filter<void, BlockItem*>(filter_mode::serial_in_order, fetch) &
                              tbb::make_filter<BlockItem*, BlockItem*>(filter_mode::parallel, parse) &
                              tbb::make_filter<BlockItem*, BlockItem*>(filter_mode::serial_in_order, filter) &
                              tbb::make_filter<BlockItem*, BlockItem*>(filter_mode::parallel, prepare) &
                              tbb::make_filter<BlockItem*, void>(filter_mode::serial_in_order, put));
    });
}

}  // namespace ripplenotch
