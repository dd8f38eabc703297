// SPDX-License-Identifier: MIT
#pragma once
// The descriptors of a joint from one log: lines and ratio are those of an identification, all else is one
// fit of the model, with what the motion does not tell left out of it.

#include <optional>
#include <vector>

#include "ripplenotch/analysis/identification.hpp"
#include "ripplenotch/core/gear_account.hpp"
#include "ripplenotch/core/trace.hpp"
#include "ripplenotch/fleet/feature_line.hpp"

namespace ripplenotch {

struct Features {
    MotionMix mix;
    std::vector<Descriptor> descriptors;  ///< always the same ones, but for those of the orders of ripple
};

/// `found`: what identify says of the log. `stated`: the gear that the user states; its ratio and orders are
/// those of the ripple then, and else those that were found. Samples beyond 2^14 are thinned out evenly.
/// Throws DataError: fewer samples than values to be fitted, or times that do not increase.
[[nodiscard]] Features features_of(const TraceView& log, const Identification& found,
                                   const std::optional<GearAccount>& stated);

}  // namespace ripplenotch
