// SPDX-License-Identifier: MIT
#pragma once
// The gear ratio Kg from the combs that output orders lie on: n Kg, where the wave generator turns against
// the spline that stands still, and n (Kg + 1) or n (Kg - 1) against the one that moves.

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "ripplenotch/core/quantity.hpp"

namespace ripplenotch {

struct RatioCandidate {
    double value = 0.0;
    double score = 0.0;  ///< 0..1, sums to at most 1 over the candidates
    std::string reason;
    bool other_unit = false;  ///< only if the motion is in another unit than it was read in
};

/// Gear ratio from f = n Kg |v| / 360.
struct GearRatioFit {
    std::optional<double> value;  ///< empty when nothing supports one
    double standard_error = 0.0;
    double ci95_low = 0.0, ci95_high = 0.0;
    /// Turns of the wave generator against the other spline, value + 1 or value - 1, where lines lie on its
    /// multiples as well.
    std::optional<double> second_comb;
    bool coarse = false;  ///< ci95 holds ratios one apart, as those of both splines are; not in joint.json
    std::vector<RatioCandidate> candidates;  ///< likeliest first
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
    bool certain = true;        ///< false: it may also be a fixed tone
    double speed_deg_s = 0.0;   ///< mean, at which the residual is stated
    double shared_error = 0.0;  ///< relative standard error of the angle, which all lines have in common
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
    std::optional<GearRatio> hint{};
    std::span<const int> hinted_orders{};  ///< n at which the strongest line is assumed to lie
};

/// Ratios are compared by their posterior probability. A line lies on a tooth of a comb within its error, or
/// anywhere by chance, which is the less probable the more clearly it is seen; a tooth has the prior
/// probability of its n (1 to 32), so that a dense comb pays for what it explains by chance. Ratios have
/// equal prior probability in the logarithm from 1 to 320, more where a catalogue has them, and more near the
/// hint. Compared as well: no gear at all (whole orders of the shaft that was measured), no connection
/// between the lines, and a mistaken unit. The scores are these probabilities. The value is left empty unless
/// one ratio has at least 0.8 and explains two lines, or one and the hint. Fit: over the lines, by Huber's
/// weights (k = 1.345); where they scatter more than their errors make likely (1 %), that widens the
/// interval, by Student's t; the error that they share comes on top. Lines that both combs make up, too close
/// together to be separated, count with the distance between the combs as their error.
[[nodiscard]] GearRatioResult fit_gear_ratio(std::span<const OrderLine> lines, const RatioQuestion& question);

}  // namespace ripplenotch
