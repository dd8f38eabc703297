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

/// A row per order and range of speed, a column per direction, and a sentence per order; empty without any.
[[nodiscard]] std::string amplitude_table(const AmplitudeBySpeed& found);

}  // namespace ripplenotch
