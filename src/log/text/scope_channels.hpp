// SPDX-License-Identifier: MIT
#pragma once
// TwinCAT Scope exports whose channels have columns of times of their own.

#include <memory>
#include <string>

#include "ripplenotch/core/files.hpp"
#include "ripplenotch/log/format.hpp"
#include "ripplenotch/log/layout.hpp"

namespace ripplenotch {

/// Opens a text log. Of an export with several columns of times all is held in memory, for a group of
/// channels may end or slip at any row: where all agree within half a step in every row, it is read as any
/// text log is. Else its channels are joined by time to those of the torque, as the topics of a recording are
/// (--join).
[[nodiscard]] std::unique_ptr<LogReader> open_text(std::unique_ptr<ByteSource> source,
                                                   std::string first_bytes, const ReadOptions& options);

}  // namespace ripplenotch
