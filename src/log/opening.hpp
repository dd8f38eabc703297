// SPDX-License-Identifier: MIT
#pragma once
// The first rows of a log, by which its clock and its position are judged before anything is done with them.

#include <deque>
#include <vector>

#include "ripplenotch/log/format.hpp"

namespace ripplenotch {

struct Opening {
    std::deque<RowBlock> blocks;      ///< read ahead
    std::vector<std::size_t> counts;  ///< rows of each block that belong to the opening
    std::vector<double> time_s;       ///< of those
    bool whole_log = false;           ///< nothing is left in the reader
};

/// The first clock_rows rows; fewer of wide logs, still a second or so. Which rows these are depends on the
/// log alone, not on how its bytes arrive: a pipe and a file must give the same coefficients.
[[nodiscard]] Opening read_opening(LogReader& reader);

/// The blocks read ahead, then those of the reader; false when there are none left.
bool next_block(Opening& opening, LogReader& reader, RowBlock& block);

}  // namespace ripplenotch
