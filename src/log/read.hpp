// SPDX-License-Identifier: MIT
#pragma once
#include <cstddef>
#include <memory>
#include <optional>
#include <string>

#include "ripplenotch/core/files.hpp"
#include "ripplenotch/log/log.hpp"

namespace ripplenotch {

// Internal to the log room: reading on until there is enough, or no more.

/// Behind the first `have` of `bytes`, until there are `size` or the source ends; returns how many there are.
/// The room grows with what comes: most logs are short of what is asked for.
[[nodiscard]] std::size_t read_on(ByteSource& source, std::string& bytes, std::size_t have, std::size_t size);

// Internal to the log room: evenly spread pieces of a log that is too long to be held.

/// Pieces of a log with more than `most_rows`, nothing of a shorter one. See read_log_in_part. `joint`: by
/// its place, where options.every_joint reads several.
[[nodiscard]] std::optional<Log> read_pieces(const std::shared_ptr<const Spool>& log,
                                             const ReadOptions& options, std::size_t most_rows,
                                             std::size_t joint = 0);

}  // namespace ripplenotch
