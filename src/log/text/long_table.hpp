// SPDX-License-Identifier: MIT
#pragma once
// Text logs in which a row holds one number: tables of time, signal and value, and traces with a block of
// rows for each variable.

#include <memory>
#include <string>
#include <string_view>

#include "ripplenotch/core/files.hpp"
#include "ripplenotch/log/format.hpp"
#include "ripplenotch/log/layout.hpp"

namespace ripplenotch {

/// Whether the first lines may be those of such a log.
[[nodiscard]] bool may_be_long(std::string_view first_bytes);

/// Opens it, `first_bytes` read already, with a column for each signal; as any other text where a trace has
/// one block only. Signals with other times than the torque's are joined to it by ReadOptions::join. Throws
/// DataError with the line where a cell is no number or time runs backward.
[[nodiscard]] std::unique_ptr<LogReader> open_long(std::unique_ptr<ByteSource> source,
                                                   std::string first_bytes, const ReadOptions& options);

}  // namespace ripplenotch
