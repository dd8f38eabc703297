// SPDX-License-Identifier: MIT
#pragma once
// Tables of text, in some of which columns have times of their own.

#include <memory>
#include <string>

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

}  // namespace ripplenotch
