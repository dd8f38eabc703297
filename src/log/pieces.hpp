// SPDX-License-Identifier: MIT
#pragma once
// Internal to the log room: evenly spread pieces of a log that is too long to be held.

#include <cstddef>
#include <memory>
#include <optional>

#include "ripplenotch/core/spool.hpp"
#include "ripplenotch/log/log.hpp"

namespace ripplenotch {

/// Of a log with more than `most_rows`, nothing of a shorter one. See read_log_in_part. `joint`: by its
/// place, where options.every_joint reads several.
[[nodiscard]] std::optional<Log> read_pieces(const std::shared_ptr<const Spool>& log,
                                             const ReadOptions& options, std::size_t most_rows,
                                             std::size_t joint = 0);

}  // namespace ripplenotch
