// SPDX-License-Identifier: MIT
#pragma once
// Internal to the analysis room: combs n * ratio that output orders may lie on, and how likely each is.

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "ripplenotch/analysis/gear_ratio.hpp"

namespace ripplenotch {

/// Ratios of joints nearly always lie here, and these are sold: the usual ones of component sets, and one
/// more for each of the larger where the circular spline is the output instead of the flexspline.
inline constexpr double lowest_usual_ratio = 25.0, highest_usual_ratio = 320.0;
inline constexpr std::array catalogue_ratios{30.0, 50.0, 80.0, 100.0, 101.0, 120.0, 121.0, 160.0, 161.0};

// In nats: how much likelier each makes a candidate. By judgement: a ratio out of the catalogue is some four
// times likelier than any other, and a hint of the user outweighs nearly all that lines say.
inline constexpr double catalogue_nats = 1.5, unusual_nats = -5.0, hint_nats = 8.0;

inline constexpr double hint_share = 0.015;  // as near as this to a ratio, a hint agrees with it

struct Comb {
    double ratio = 0.0;
    std::vector<std::optional<int>> n;  // per line
    double nats = 0.0;
    int common = 0;  // greatest common divisor of the n
    std::size_t matches = 0;
    std::optional<double> listed;  // the catalogue's value, when it lies on one
    bool hinted = false;
    std::string reason;
};

[[nodiscard]] inline bool usual_ratio(double ratio) {
    return ratio >= lowest_usual_ratio && ratio <= highest_usual_ratio;
}

/// The catalogue's ratio near this one.
[[nodiscard]] std::optional<double> listed_ratio(double ratio);

/// Combs on which at least one line lies, likeliest first, no two of nearly the same ratio.
[[nodiscard]] std::vector<Comb> all_combs(std::span<const OrderLine> lines, std::optional<GearRatio> hint,
                                          std::span<const int> hinted_orders);

}  // namespace ripplenotch
