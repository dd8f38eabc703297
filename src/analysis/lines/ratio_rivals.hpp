// SPDX-License-Identifier: MIT
#pragma once
// Internal to the analysis room: ratios that the lines would show if the log were not what it says it is.

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "analysis/lines/comb.hpp"

namespace ripplenotch {

/// A ratio that would be the true one under a mistake in the log, with how likely that is beside the combs.
struct RatioRival {
    double ratio = 0.0;
    double nats = 0.0;
    std::string reason;  ///< "if the speed is in rad/s, not deg/s"
    std::string note;    ///< what is to be said about it
};

/// Units of speed mixed up (rad, rpm, turns, a factor of 60), where that makes an unusual ratio a usual one
/// of the catalogue or of the hint.
[[nodiscard]] std::vector<RatioRival> unit_rivals(const Comb& best, std::optional<GearRatio> hint);

/// For a line on its own that may be the image of a higher order: the ratios of what it could be.
[[nodiscard]] std::vector<RatioRival> fold_rivals(std::span<const OrderLine> lines,
                                                  std::optional<GearRatio> hint,
                                                  std::span<const int> hinted_orders);

/// A clock that is off, where only the clock makes an angle of the speed, and the hint would then hold.
[[nodiscard]] std::optional<RatioRival> clock_rival(const Comb& best, GearRatio hint);

/// A ratio is a ratio of teeth: when the lines lie off the hinted one by more than their errors allow and by
/// little, the speed's or position's scale is the likelier culprit.
[[nodiscard]] std::optional<RatioRival> scale_rival(const Comb& best, const GearRatioFit& fit,
                                                    GearRatio hint);

}  // namespace ripplenotch
