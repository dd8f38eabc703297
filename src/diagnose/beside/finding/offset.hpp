// SPDX-License-Identifier: MIT
#pragma once
// The zero of the measured torque beside an arm: always on, and a finding where the log tells it.

#include <optional>
#include <span>
#include <vector>

#include "diagnose/beside/finding/sizes.hpp"
#include "diagnose/beside/naming/conditions.hpp"

namespace ripplenotch {

struct OffsetBeside {
    BesideFinding finding;
    BesideValues values;
    double own_nm = 0.0;  ///< of its torque, what an arm's weight cannot explain
};

/// `lens`: in which `believed` was found beside `model`. Nothing where the offset is not examined, the model
/// has one, the arm explains it as well, or it is not worth its price.
[[nodiscard]] std::optional<OffsetBeside> offset_beside(const Lens& lens, const Candidate& model,
                                                        std::span<const Effect* const> examined,
                                                        std::vector<Shape> believed);

}  // namespace ripplenotch
