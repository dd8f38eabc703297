// SPDX-License-Identifier: MIT
#pragma once
// Internal to the log room: the rows of a text log that a range keeps, as the bytes of a log of their own.

#include <memory>
#include <string>

#include "ripplenotch/log/format.hpp"

namespace ripplenotch {

/// LogFormat::cut of text logs: its head, and the lines inside as they stand. Comments and blank lines go
/// with the row before them. Reads ahead until two rows are kept.
[[nodiscard]] LogCut cut_text(std::unique_ptr<ByteSource> source, std::string first_bytes,
                              const ReadOptions& options);

}  // namespace ripplenotch
