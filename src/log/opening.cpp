// SPDX-License-Identifier: MIT
#include "log/opening.hpp"

#include <utility>

#include "ripplenotch/log/clock.hpp"

namespace ripplenotch {
namespace {

constexpr std::size_t most_bytes = std::size_t{8} << 20;

}  // namespace

Opening read_opening(LogReader& reader) {
    Opening opening;
    std::size_t bytes = 0;
    while (opening.time_s.size() < clock_rows && bytes < most_bytes) {
        RowBlock block;
        if (!reader.next(block)) {
            opening.whole_log = true;
            break;
        }
        std::size_t count = 0;
        while (count < block.size() && opening.time_s.size() + count < clock_rows &&
               (count >= block.row_end.size() || bytes + block.row_end[count] < most_bytes)) {
            ++count;
        }
        opening.time_s.insert(opening.time_s.end(), block.time_s.begin(),
                              block.time_s.begin() + static_cast<std::ptrdiff_t>(count));
        opening.counts.push_back(count);
        bytes += block.bytes.size();
        opening.blocks.push_back(std::move(block));
    }
    return opening;
}

bool next_block(Opening& opening, LogReader& reader, RowBlock& block) {
    if (opening.blocks.empty()) return reader.next(block);
    block = std::move(opening.blocks.front());
    opening.blocks.pop_front();
    return true;
}

}  // namespace ripplenotch
