// SPDX-License-Identifier: MIT
#pragma once
// The gear ratio as the comb that output orders lie on: order_output = n * Kg, n a small integer.

#include <optional>
#include <span>
#include <vector>

#include "ripplenotch/analysis/identification.hpp"

namespace ripplenotch {

/// One measurement of a line: at one speed, or over a whole motion.
struct OrderObservation {
    double order_output = 0.0;
    double error = 0.0;  ///< standard error of order_output from the line's own noise
    double speed_deg_s = 0.0;
    double speed_share_error = 0.0;  ///< relative standard error of the speed it was divided by
    double hz = 0.0;
    std::size_t source = 0;  ///< observations of one source share the speed, and its error
};

/// A line that turns with the joint, by all its observations.
struct OrderLine {
    double order_output = 0.0;
    double error = 0.0;
    double snr = 0.0;
    double amplitude_nm = 0.0;
    bool certain = true;  ///< false: it may also be a fixed tone
    std::vector<OrderObservation> observations;
    std::vector<double> could_be = {};  ///< orders beyond half the sample rate that would look the same
};

struct GearRatioResult {
    GearRatioFit fit;
    std::vector<std::optional<int>>
        order_of_line;  ///< n of each line under fit.value; empty where it lies off the comb
    std::vector<std::string> notes;
};

/// What is known beside the lines.
struct RatioQuestion {
    std::optional<GearRatio> hint{};
    std::span<const int> hinted_orders{};  ///< n at which the strongest line is believed to stand
    bool clock_in_doubt = false;  ///< the angle is velocity times time: a wrong clock scales every order
    double shared_error = 0.0;    ///< relative standard error that all orders have in common
};

/// n runs from 1 to 8 for a line on its own and to 16 for lines that a comb explains besides. Every candidate
/// is scored by how unlikely its matches are by chance, by whether odd lines set it apart from its half, by
/// what real drives look like (ratios 25 to 320, n = 2 most often alone), by catalogue ratios, and by the
/// hint; beside the combs stand ratios that a mistake in the log would explain: a unit of speed, with a hint
/// also a clock or a scale. The scores are shares of one. The value is left empty unless one comb has at
/// least 0.7. Fit: per source the weighted mean over its lines, then over sources by Huber's weights
/// (k = 1.345); where sources scatter more than their errors make likely (1 %), that widens the interval, by
/// Student's t.
[[nodiscard]] GearRatioResult fit_gear_ratio(std::span<const OrderLine> lines, const RatioQuestion& question);

}  // namespace ripplenotch
