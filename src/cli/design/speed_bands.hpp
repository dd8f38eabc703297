// SPDX-License-Identifier: MIT
#pragma once
// Speed ranges as people type them: "18:180:18", "0.3rad/s:3rad/s", "18:36,36:60,60:100deg/s".

#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "ripplenotch/core/units.hpp"

namespace ripplenotch {

struct SpeedRange {
    DegPerSec from, to;
    std::optional<DegPerSec> width;  ///< of one band; empty for FROM:TO
};

/// Reads FROM:TO or FROM:TO:WIDTH. Either each number has its unit, or only the last and it holds for all, or
/// none and all are deg/s. Throws UsageError that names `what`.
[[nodiscard]] SpeedRange parse_speed_range(std::string_view text, std::string_view what);

/// Reads FROM:TO,FROM:TO,... by the same rules, each band for itself.
[[nodiscard]] std::vector<std::pair<DegPerSec, DegPerSec>> parse_speed_bands(std::string_view text,
                                                                             std::string_view what);

}  // namespace ripplenotch
