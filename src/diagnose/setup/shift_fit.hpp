// SPDX-License-Identifier: MIT
#pragma once
// Least squares of a series by another one that is shifted in time, with nuisance columns.

#include <span>
#include <string>
#include <vector>

#include "diagnose/setup/smoothed_series.hpp"
#include "ripplenotch/diagnose/alignment.hpp"

namespace ripplenotch {

/// A smoothed series, or its slope in time.
struct SmoothedSignal {
    const SmoothedSeries& series;
    bool is_slope = false;

    [[nodiscard]] double value(double at_s) const {
        return is_slope ? series.slope(at_s) : series.mean(at_s);
    }
    [[nodiscard]] double derivative(double at_s) const {
        return is_slope ? series.curvature(at_s) : series.slope(at_s);
    }
};

struct ShiftProblem {
    std::vector<double> at_s;                    ///< ascending; of the log
    std::vector<double> target;                  ///< of the log, at these times
    std::vector<std::vector<double>> nuisances;  ///< at these times
    SmoothedSignal simulated;
    double range_s = 1.0, smoothing_s = 0.05;
    double misfit_share = 0.0;  ///< of SimulationLag::misfit_s that the interval holds besides
};

struct ShiftFit {
    SimulationLag lag;
    double held_out_squares = 0.0;  ///< of blocks that the fit was made without
};

/// The lag and what else `SimulationLag` holds, but for the agreement of motions.
[[nodiscard]] ShiftFit fit_shift(const ShiftProblem& problem, const AlignmentOptions& options);

/// Why a lag with such an interval is not identifiable.
[[nodiscard]] std::string too_wide(const SimulationLag& lag);

/// Largest lag of a search along these times of a log.
[[nodiscard]] double search_range_s(std::span<const double> time_s, const AlignmentOptions& options);

/// Times half a window apart at which all these series are covered.
[[nodiscard]] std::vector<double> window_times(const std::vector<const SmoothedSeries*>& series,
                                               double smoothing_s);

}  // namespace ripplenotch
