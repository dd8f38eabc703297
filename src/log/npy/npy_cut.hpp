// SPDX-License-Identifier: MIT
#pragma once
// Internal to the log room: the rows of an array that a range keeps, as an array of their own.

#include <memory>
#include <string>

#include "ripplenotch/log/format.hpp"

namespace ripplenotch {

/// LogFormat::cut of arrays. An array's head says how many rows follow, so the whole log is gone through
/// first, and what is kept waits in a temporary file.
[[nodiscard]] LogCut cut_npy(std::unique_ptr<ByteSource> source, std::string first_bytes,
                             const ReadOptions& options);

}  // namespace ripplenotch
