// SPDX-License-Identifier: MIT
#pragma once
// Signals of other topics, which have clocks of their own, beside the rows of one.

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "log/messages/message_rows.hpp"

namespace ripplenotch {

/// What a row gets of a signal that was not recorded in the same moment.
enum class Join {
    nearest,  ///< the value of the message nearest in time
    hold,     ///< of the last one before
    linear    ///< between the two around it
};
/// "linear" and the like. Throws UsageError.
[[nodiscard]] Join join_named(std::string_view word);

/// One number of the messages of another topic.
struct SideSignal {
    std::string path;                         ///< "/ft.wrench.torque.z"
    std::string read_as;                      ///< as MessageLeaf has it
    std::unique_ptr<MessageRecords> records;  ///< its clock and the number, nothing else
    NpyField type;                            ///< of the number, behind the clock
    std::int64_t limit_ns = 0;                ///< the farthest message that is taken
};

/// The rows of `base`, which gives all its fields, its clock first; behind them the sides, in 8 bytes each.
/// Rows before the first message of a side and behind its last are left out. read() throws DataError where a
/// side is farther than its limit.
[[nodiscard]] std::unique_ptr<RecordSource> join_records(std::unique_ptr<MessageRecords> base,
                                                         std::vector<std::size_t> base_sizes,
                                                         std::vector<SideSignal> sides, Join how);

}  // namespace ripplenotch
