// SPDX-License-Identifier: MIT
#pragma once
// Internal to the analysis room: how well the sweeps know the place of a line.

#include <span>

#include "ripplenotch/analysis/stack.hpp"

namespace ripplenotch {

/// Standard error of the place of the largest summed power, in turns or hertz. First what the noise beside
/// the line makes of it (one Newton step, delta method, with the sweeps' own weights). Where the sweeps, or
/// thirds of them when they are few, put the line more apart than that noise explains, as a phase that
/// wanders with speed or load does, the error is widened to what they show.
[[nodiscard]] double place_error(std::span<const Sweep> sweeps, const Stack& stack, double place);

/// Mean noise power |S|^2 of a sweep at a place; 0 where the sweep is not used there.
[[nodiscard]] double noise_at(const Stack& stack, std::size_t sweep, double place);

/// True when to look at one place in all sweeps is worth a second thread.
[[nodiscard]] bool are_long(std::span<const Sweep> sweeps);

}  // namespace ripplenotch
