// SPDX-License-Identifier: MIT
#pragma once
// Signals with clocks of their own, of another topic or another array, beside the rows of one.

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "log/npy/npy_field.hpp"
#include "log/records/record_table.hpp"

namespace ripplenotch {

/// What a row gets of a signal that was not recorded in the same moment.
enum class Join {
    nearest,  ///< the value of the message nearest in time
    hold,     ///< of the last one before
    linear    ///< between the two around it
};
/// "linear" and the like. Throws UsageError.
[[nodiscard]] Join join_named(std::string_view word);

/// One number with a clock of its own.
struct SideSignal {
    std::string path;                       ///< "/ft.wrench.torque.z", "q_dot.Data"
    std::string read_as;                    ///< what the path means beside the others
    std::unique_ptr<RecordSource> records;  ///< its clock in nanoseconds and the number, nothing else
    NpyField type;                          ///< of the number, behind the clock
    std::int64_t limit_ns = 0;              ///< the farthest in time that is taken
    std::string unit;                       ///< as the file states it
    std::string_view noun = "message";      ///< what one number of it is called
};
/// The farthest in time that is taken of a signal with this usual step.
[[nodiscard]] std::int64_t join_limit_ns(double period_ns);

/// What the table of a base, and its user, are told of the sides behind it.
void add_sides(const std::vector<SideSignal>& sides, std::string_view how, RecordTable& table);

/// The rows of `base`, which gives all its fields, its clock first; behind them the sides, in 8 bytes each.
/// Rows before the first message of a side and behind its last are left out. read() throws DataError where a
/// side is farther than its limit.
[[nodiscard]] std::unique_ptr<RecordSource> join_records(std::unique_ptr<RecordSource> base,
                                                         std::vector<std::size_t> base_sizes,
                                                         std::vector<SideSignal> sides, Join how);

}  // namespace ripplenotch
