// SPDX-License-Identifier: MIT
#pragma once
// Internal to the analysis module: a line's place and amplitude by least squares over the sweeps, each with a
// phase of its own.

#include <span>
#include <vector>

#include "ripplenotch/analysis/line_search.hpp"

namespace ripplenotch {

/// The noise of each sweep beside a line.
struct LineNoise {
    Axis axis = Axis::angle;
    double resolution = 0.0;    ///< width of a line
    std::vector<double> power;  ///< of the sum under the sweep's weights; 0 where the sweep is not used
};

/// Place of the maximum of the summed power over noise within a reach, by Newton steps.
double refined(std::span<const Sweep> sweeps, const LineNoise& noise, double start, double reach);

/// Improvement in log-likelihood (natural units) by a line at a place, of a phase of its own in each sweep,
/// beyond what noise gives.
double explained(std::span<const Sweep> sweeps, const LineNoise& noise, double place);

/// Fills in the results of the sweeps for a line at `place`.
void measure(std::span<const Sweep> sweeps, const LineNoise& noise, double place, MotionLine& line);

}  // namespace ripplenotch
