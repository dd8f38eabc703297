// SPDX-License-Identifier: MIT
#pragma once
// Internal to the analysis module: gear ratios that could explain a list of lines, compared by their
// evidence.

#include <cmath>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "ripplenotch/analysis/gear_ratio.hpp"

namespace ripplenotch {

/// Where a line lies under a hypothesis: order_output = n (ratio + shift).
struct CombPosition {
    int n = 0;
    double shift = 0.0;   ///< 0, or that of the second comb; half of it where both combs make up the line
    double spread = 0.0;  ///< standard deviation of the shift; 0 where the line lies on one of the combs

    [[nodiscard]] bool of_both() const { return std::abs(shift) == 0.5; }
};

/// One explanation of the lines.
struct RatioHypothesis {
    double ratio = 0.0;       ///< as the log is read
    double value = 0.0;       ///< ratio of the gear: differs from `ratio` where a unit is mistaken
    double error = 0.0;       ///< standard error of the ratio
    int second_comb = 0;      ///< lines also at n (ratio + 1) or n (ratio - 1); 0: none
    bool as_read = true;      ///< false: only if the log differs from its own description
    bool other_unit = false;  ///< a unit is mistaken
    bool hinted = false;
    bool listed = false;  ///< a catalogue has it
    double log_evidence = 0.0;
    /// Position of each line; empty where it lies off the combs.
    std::vector<std::optional<CombPosition>> position;
    std::string reason;
    /// Other forms of it, of nearly the same value: one comb or two, lines on the one or on the other. Each
    /// with its own evidence, that of this form being `own_evidence`; log_evidence is of all together.
    std::vector<RatioHypothesis> forms;
    double own_evidence = 0.0;
};

inline constexpr double hint_tolerance = 0.015;  ///< an expected ratio agrees with one as near as this

/// The catalogue's ratio that this one may be, by its standard error.
[[nodiscard]] std::optional<double> catalogue_ratio(double ratio, double error);

/// Explanations that at least one line supports, the most probable first, no two of one value.
[[nodiscard]] std::vector<RatioHypothesis> ratio_hypotheses(std::span<const OrderLine> lines,
                                                            const RatioQuestion& question);

/// Logarithm of the evidence that the lines have nothing to do with each other.
[[nodiscard]] double log_evidence_of_chance(std::span<const OrderLine> lines);

}  // namespace ripplenotch
