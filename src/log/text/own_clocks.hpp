// SPDX-License-Identifier: MIT
#pragma once
// Text logs that are no table of one clock: a row or a block holds one signal, columns have times of their
// own, cells hold lists.

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "ripplenotch/core/files.hpp"
#include "ripplenotch/log/format.hpp"
#include "ripplenotch/log/layout.hpp"

namespace ripplenotch {

/// Opens a table, `first_bytes` read already. The numbers of lists in its cells are columns each. Where
/// columns have times of their own (TextDialect::own_clocks), all is held in memory and the motion is joined
/// to the torque by ReadOptions::join; those of one time in every row, up to half a step, are read as any
/// text. Throws DataError.
[[nodiscard]] std::unique_ptr<LogReader> open_table(std::unique_ptr<ByteSource> source,
                                                    std::string first_bytes, const ReadOptions& options);

// Text logs in which a row holds one number: tables of time, signal and value, and traces with a block of
// rows for each variable.

/// Whether the first lines may be those of such a log.
[[nodiscard]] bool may_be_long(std::string_view first_bytes);

/// Opens it, `first_bytes` read already, with a column for each signal; as any other text where a trace has
/// one block only. Signals with other times than the torque's are joined to it by ReadOptions::join. Throws
/// DataError with the line where a cell is no number or time runs backward.
[[nodiscard]] std::unique_ptr<LogReader> open_long(std::unique_ptr<ByteSource> source,
                                                   std::string first_bytes, const ReadOptions& options);

/// The numbers of a list in one cell, "[0.1, 0.2]" or "(0.1 0.2)"; none where it is no such.
[[nodiscard]] std::optional<std::vector<double>> list_in(std::string_view cell);

}  // namespace ripplenotch
