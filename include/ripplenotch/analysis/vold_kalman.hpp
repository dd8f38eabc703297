// SPDX-License-Identifier: MIT
#pragma once
// Order tracks without windows: the second-generation Vold-Kalman filter, all lines jointly.

#include "ripplenotch/analysis/order_track.hpp"

namespace ripplenotch {

/// Weight r of the smoothness of an envelope against the data, for a -3 dB width of `bandwidth_share` times
/// the sample rate: r = sqrt(sqrt 2 - 1) / (2 sin(pi share / 2))^poles (Tuma 2005; share = bandwidth / rate).
/// Throws UsageError unless 1 <= poles <= 4 and 0 < share < 1, and where the equations would be so badly
/// conditioned (1 + 4^poles r^2 above 1e13) that rounding shows in the third digit.
[[nodiscard]] double vold_kalman_weight(double bandwidth_share, int poles);

struct VoldKalmanRule {
    Hertz bandwidth{1.0};  ///< two-sided -3 dB bandwidth of each envelope
    int poles = 2;         ///< 1 to 4: how steeply the filter falls beyond
    bool trend = true;     ///< a smooth torque of four times the bandwidth is estimated along with the lines
    /// Samples per point of the envelopes; 0 chooses 40 points in 1/bandwidth, between which they are
    /// straight.
    std::size_t samples_per_point = 0;
    Hertz rows_per_second{
        0.0};  ///< rows of the result; 0 gives eight in 1/bandwidth, and never fewer than one point
};

struct VoldKalmanTracks {
    OrderTracks tracks;     ///< rows_not_separable counts rows with a nan and rows left out
    Hertz bandwidth;        ///< as obtained in the middle of the longest run, from the equations solved
    Seconds envelope_step;  ///< between points of the envelopes
    std::size_t runs_too_short = 0;                ///< left out: shorter than 1.5 / bandwidth
    std::vector<std::vector<double>> waveform_nm;  ///< per line and sample: its part of the torque
    std::vector<double> trend_nm;                  ///< per sample; both are nan in runs left out
};

/// Minimises the sum over samples of (torque - trend - sum of a cos(2 pi order turns) - b sin(...))^2, plus
/// r^2 / 2 times the squared differences of order `poles` of every a and b, plus r^2 times those of the
/// trend; r from vold_kalman_weight. That is the second-generation criterion (Vold, Mains, Blough, SAE
/// 972007, 1997) for real signals: there a complex envelope meets one line of a pair, here both, hence the
/// half. a, b and trend are points every samples_per_point with straight lines between, which at 40 points
/// in 1/bandwidth changes them by less than 0.1 %, keeps any bandwidth well conditioned and takes clocks that
/// jitter. Sparse Cholesky factorisation, O(n). A gap in time ends a run; each run is solved alone.
///
/// A line is nan where its frequency is below four times the bandwidth, for there the trend reaches (with no
/// trend: below the bandwidth, for there it meets its own mirror image), and where it keeps within half the
/// bandwidth of another line for most of 8/bandwidth. Lines may cross. Rows in which every line is nan are
/// left out. standard_error_nm holds for white noise, ends of runs included, away from such places.
/// Throws UsageError for the rules above, and DataError when no run lasts 1.5 / bandwidth, naming the
/// bandwidth that the log can give.
[[nodiscard]] VoldKalmanTracks track_vold_kalman(const TrackedSignal& signal, const VoldKalmanRule& rule);

}  // namespace ripplenotch
