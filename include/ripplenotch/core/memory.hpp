// SPDX-License-Identifier: MIT
#pragma once
// How much memory a run may still take: asked before work that holds a whole log.

#include <cstdint>
#include <optional>

namespace ripplenotch {

/// In bytes: the least of what the system has left, of the limit of the process (ulimit -v) and of that of
/// its control group (containers). Empty where nobody says any of them.
[[nodiscard]] std::optional<std::uint64_t> memory_to_be_had();

}  // namespace ripplenotch
