// SPDX-License-Identifier: MIT
#pragma once
// Internal to the analysis module: a line's place and amplitude by least squares over the sweeps, each with a
// phase of its own.

#include <complex>
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

/// Standard error of the position of the largest summed power, in turns or hertz. First from the noise near
/// the line (one Newton step, delta method). Where the estimates of the sweeps, or thirds of them when they
/// are few, scatter more than that noise explains, as with a phase that drifts with speed or load, the error
/// is widened to their scatter.
double place_error(std::span<const Sweep> sweeps, const LineNoise& noise, double place);

/// Fills in amplitude, phase and their floor of a line at `place`, from its complex amplitude (Nm) in each
/// sweep. A tone is measured at rest or in motion, where it is larger: some are of one of the two only.
void measure(std::span<const Sweep> sweeps, const LineNoise& noise, double place,
             std::span<const std::complex<double>> amplitudes, MotionLine& line);

}  // namespace ripplenotch
