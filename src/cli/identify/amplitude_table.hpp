// SPDX-License-Identifier: MIT
#pragma once
// What identify prints of the amplitude by speed and direction.

#include <optional>
#include <span>
#include <string>

#include "ripplenotch/analysis/identification.hpp"
#include "ripplenotch/core/quantity.hpp"
#include "ripplenotch/log/log.hpp"

namespace ripplenotch {

/// Adds the amplitudes by speed and direction at the ripple orders that were found; without a ratio in the
/// lines, with the one stated, at those that gears have. Nothing where the lines are doubted.
void add_amplitudes(Identification& found, std::span<const Log> logs, std::optional<GearRatio> stated);

/// A row per order and range of speed, a column per direction, and a sentence per order; empty without any.
[[nodiscard]] std::string amplitude_table(const AmplitudeBySpeed& found);

}  // namespace ripplenotch
