// SPDX-License-Identifier: MIT
#pragma once
// TwinCAT Scope exports whose channels have columns of times of their own.

#include <memory>
#include <string>

#include "ripplenotch/core/files.hpp"
#include "ripplenotch/log/format.hpp"
#include "ripplenotch/log/layout.hpp"

namespace ripplenotch {

/// Whether the first bytes of a text may be those of a TwinCAT Scope export.
[[nodiscard]] bool may_be_scope_export(std::string_view first_bytes);

/// Opens such a text. Of an export with several columns of times all is held in memory, for a group of
/// channels may end or slip at any row: where all agree within half a step in every row, it is read as any
/// text log is. Else its channels are joined by time to those of the torque, as the topics of a recording are
/// (--join).
[[nodiscard]] std::unique_ptr<LogReader> open_scope_export(std::unique_ptr<ByteSource> source,
                                                           std::string first_bytes,
                                                           const ReadOptions& options);

}  // namespace ripplenotch
