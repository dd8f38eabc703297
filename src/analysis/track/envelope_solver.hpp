// SPDX-License-Identifier: MIT
#pragma once
// The equations of the Vold-Kalman filter for one run of samples: envelopes on an even grid of points.

#include <span>
#include <vector>

#include "ripplenotch/analysis/motion_runs.hpp"
#include "ripplenotch/analysis/order_track.hpp"

namespace ripplenotch {

struct EnvelopeSettings {
    double samples_per_point = 1.0;
    double step_s = 0.0;  ///< between points
    int poles = 2;        ///< order of the differences that are kept small
    double weight = 0.0;  ///< r of those differences
    bool trend = true;
    double trend_weight = 0.0;         ///< r of the trend's differences
    std::size_t overlap_points = 400;  ///< sections of a long run share so many with each neighbour
};

struct EnvelopeGrid {
    double start_s = 0.0, step_s = 0.0;
    std::size_t points = 0;
};
[[nodiscard]] EnvelopeGrid make_grid(std::span<const double> time_s, double step_s);

/// Components are cosine and minus sine of line 0, of line 1, ..., then the trend.
struct Envelopes {
    EnvelopeGrid grid;
    std::vector<std::vector<double>> value;  ///< per component and point

    /// Between points along a straight line.
    [[nodiscard]] double at(std::size_t component, double time_s) const;
};

/// Solved in sections of at most some thousand points that overlap by settings.overlap_points, so that memory
/// stays bounded; the overlap is long enough for their ends not to matter.
[[nodiscard]] Envelopes solve_envelopes(const TrackedSignal& signal, const SampleRun& run,
                                        const EnvelopeGrid& grid, const EnvelopeSettings& settings);

/// What the equations of an envelope do to a signal when one line is alone, the data at their mean.
struct EnvelopeResponse {
    Hertz bandwidth;  ///< -3 dB width in the middle of the run, both sides together
    /// Standard error of an amplitude per unit of rms noise on the samples, by the distance to an end of the
    /// run in points; the last entry holds beyond.
    std::vector<double> error_factors;
    double freedom_per_sample = 0.0;  ///< degrees of freedom that one component takes from the data
};
/// Of a run of `duration_s`.
[[nodiscard]] EnvelopeResponse envelope_response(EnvelopeSettings settings, double duration_s,
                                                 Hertz asked_bandwidth);

}  // namespace ripplenotch
