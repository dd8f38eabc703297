// SPDX-License-Identifier: MIT
#pragma once
// The gear ratio Kg from the combs that output orders lie on: n Kg, where the wave generator turns against
// the spline that stands still, and n (Kg + 1) or n (Kg - 1) against the one that moves.

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "ripplenotch/core/quantity.hpp"

namespace ripplenotch {

struct RatioCandidate {
    double value = 0.0;
    double score = 0.0;  ///< posterior probability; what is left over 1 is that of no gear at all
    std::string reason;
};

/// Gear ratio from f = n Kg |v| / 360.
struct GearRatioFit {
    /// The most probable one, or the stated one; empty where none is more probable than all others together.
    std::optional<double> value;
    double standard_error = 0.0;
    double ci95_low = 0.0, ci95_high = 0.0;
    /// Turns of the wave generator against the other spline, value + 1 or value - 1, where lines lie on its
    /// multiples as well.
    std::optional<double> second_comb;
    /// The lines contradict the stated ratio, which is `value` all the same; not in joint.json.
    bool contradicted = false;
    std::vector<RatioCandidate> candidates;  ///< the stated one, then the most probable first
    /// One entry per line used: its mean speed, its frequency there and the residual of the fit, in hertz.
    struct Residual {
        double speed_deg_s = 0.0, hz = 0.0, order = 0.0, residual_hz = 0.0, weight = 1.0;
    };
    std::vector<Residual> residuals;
};

/// Ratios between which nothing decides, the most probable first; empty where there is a value, or where no
/// ratio is probable.
[[nodiscard]] std::vector<double> undecided_ratios(const GearRatioFit& fit);

/// A line that turns with the joint.
struct OrderLine {
    double order_output = 0.0;
    double error = 0.0;  ///< standard error of order_output from the line's own noise
    double snr = 0.0;
    double amplitude_nm = 0.0;
    double speed_deg_s = 0.0;   ///< mean, at which the residual is stated
    double shared_error = 0.0;  ///< relative standard error of the angle, which all lines have in common
    double sweeps = 1.0;        ///< that show it, each with a noise of amplitude_nm / snr
};

struct GearRatioResult {
    GearRatioFit fit;
    /// The order of each line, per turn of the motor, under fit.value: n on the first comb, n (Kg +/- 1) / Kg
    /// on the second; empty where it lies off both.
    std::vector<std::optional<double>> order_of_line;
    std::vector<std::string> notes;
};

/// What is known in addition to the lines.
struct RatioQuestion {
    std::optional<GearRatio> hint{};        ///< stated
    std::span<const int> hinted_orders{};   ///< n at which the strongest line is assumed to lie
    double resolution = 0.0;                ///< width of a line in output orders
    double lowest = 12.0, highest = 900.0;  ///< output orders that were searched; below are motion and load
    std::function<double(double order)> detectable_nm = {};  ///< that would have been found there
};
/// The n that hinted_orders may hold: 1 to this.
inline constexpr int highest_motor_order = 16;

/// A ratio whose probability is above this is conclusive.
inline constexpr double conclusive_probability = 0.95;

/// Ratios are compared by their posterior probability: those of strain wave gears that are sold, ratios
/// between 12 and 400 that are in no catalogue, the stated one, and no gear at all. A line is at n = 1 to 16
/// of a comb of the ratio (N, and N + 1 against the other spline) with the share of known joints that show
/// this n, or anywhere by chance; orders that are absent count against a ratio by
/// how far below the strongest line they would have been found; the strongest line counts by the share of
/// joints in which this n is the strongest, or one is that may hide. A stated ratio is kept
/// within 2 % and fitted; where its probability is below 0.05 it is contradicted. Fit: over the lines, by
/// Huber's weights (k = 1.345); where they scatter more than their errors make likely (1 %), that widens the
/// interval, by Student's t; the error that they share comes on top. A line that may be on either comb counts
/// with the distance between the combs in its error.
[[nodiscard]] GearRatioResult fit_gear_ratio(std::span<const OrderLine> lines, const RatioQuestion& question);

}  // namespace ripplenotch
