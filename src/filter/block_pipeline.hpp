// SPDX-License-Identifier: MIT
#pragma once
// Blocks of a log through five steps on several threads, in bounded memory, with one result whatever their
// number.

#include <cstddef>
#include <exception>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "ripplenotch/log/format.hpp"

namespace ripplenotch {

/// A block on its way.
struct BlockItem {
    RowBlock block;
    std::vector<std::vector<double>> torque_nm;  ///< filtered, by joint
    std::string room;                            ///< buffer of the writer
    std::string_view bytes;                      ///< to be written
    bool accepted = false;                       ///< came parsed and accepted
    std::exception_ptr error;
};

/// The steps for each block. fetch, filter and put take the blocks in their order, one at a time; parse and
/// prepare take any number at once. fetch returns false when there is no block left.
struct BlockSteps {
    std::function<bool(BlockItem&)> fetch;
    std::function<void(BlockItem&)> parse, filter, prepare, put;
};

/// Runs all blocks through the steps. The first failure in the order of the log is thrown, after the blocks
/// before it have been put: the data received by a reader of a pipe do not depend on the threads.
void run_blocks(const BlockSteps& steps, std::size_t threads);

}  // namespace ripplenotch
