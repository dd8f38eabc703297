// SPDX-License-Identifier: MIT
#pragma once
// Amplitude and phase of each line against time: least squares on the angle over sliding windows, all lines
// of all shafts at once, so that close and crossing ones are separated.

#include <cstddef>
#include <span>
#include <vector>

#include "ripplenotch/core/quantity.hpp"
#include "ripplenotch/core/trace.hpp"

namespace ripplenotch {

/// A line that repeats `order` times per turn of a shaft. With time in seconds as `turns`, a tone of `order`
/// hertz.
struct TrackedLine {
    double order = 1.0;
    std::span<const double> turns;  ///< angle of its shaft, one value a sample, signed, without jumps
};

/// A torque signal and the lines looked for in it. All spans have one value a sample; time increases.
struct TrackedSignal {
    Hertz sample_rate;
    std::span<const double> time_s, torque_nm;
    std::span<const double> speed_deg_s;      ///< signed, smooth; separates runs and is reported
    std::span<const double> reference_turns;  ///< the shaft whose turns windows are measured in
    std::vector<TrackedLine> lines;
    std::span<const std::size_t> run_starts = {};  ///< as in TraceView
    GearRatio ratio{1.0};                          ///< turns of that shaft per turn of the joint
};

/// One line along the rows of its OrderTracks; nan where it was not measured.
struct LineTrack {
    std::vector<double> amplitude_nm;       ///< zero to peak
    std::vector<double> standard_error_nm;  ///< standard error of the amplitude, from the residual
    std::vector<double> phase_deg;          ///< phase in cos(2 pi order turns + phase), -180 to 180
    std::vector<double> hz;                 ///< frequency there
};

struct OrderTracks {
    std::vector<double> time_s, speed_deg_s;  ///< per row
    std::vector<LineTrack> lines;             ///< in the order of TrackedSignal::lines
    double residual_rms_nm = 0.0;             ///< torque that neither the lines nor the trend explain
    std::size_t rows_folded = 0;              ///< rows in which a line lies above half the sample rate
    std::size_t rows_not_separable = 0;       ///< left out: lines too much alike within the window
    std::size_t windows_too_few_samples = 0;  ///< left out: fewer than two samples per unknown
};

struct WindowRule {
    double turns = 8.0;       ///< length in turns of the reference shaft, unless `seconds` is above 0
    Seconds seconds{0.0};     ///< length in time
    double hop = 0.25;        ///< windows start so much of a length apart, or a little closer
    int envelope_degree = 2;  ///< amplitude within a window: 0 constant, 1 or 2 polynomial in time
};

/// The window in turns that separates lines of these orders: eight periods of the lowest, and two of the
/// smallest difference.
[[nodiscard]] double separating_window_turns(std::span<const double> orders);

/// In each window x = trend + sum over lines of a cos(2 pi order turns) + b sin(...) is fitted, a and b being
/// polynomials in time of WindowRule::envelope_degree and the trend a cubic in time, or a polynomial of 12
/// terms per turn of the joint; reported is what holds at the window's middle.
/// A window lies within one direction of motion and holds no gap; a run between half and one window long is
/// one window. Throws UsageError for a signal without lines, orders not above 0 or a rule that makes no
/// sense. O(n).
[[nodiscard]] OrderTracks track_orders(const TrackedSignal& signal, const WindowRule& rule);

/// Rows of tracks gathered by signed speed. All vectors have one value a speed, slowest (most negative)
/// first.
struct SpeedTrack {
    std::vector<double> speed_deg_s;  ///< mean of the rows gathered
    std::vector<std::size_t> rows;    ///< how many
    struct Line {
        std::vector<double> amplitude_nm;  ///< zero to peak, mean of the rows
        /// Standard deviation of the rows' amplitudes; with one row, its own standard error.
        std::vector<double> spread_nm;
        /// Phase of the mean of all rows, each a phasor of its amplitude and phase.
        std::vector<double> phase_deg;
        std::vector<double> hz;  ///< mean
    };
    std::vector<Line> lines;  ///< nan where no row of that speed has the line
    double step_deg_s = 0.0;  ///< width of a speed's range, as used
};

/// A step of 0 takes speed_step of the speeds that occur. Ranges without a row are left out.
[[nodiscard]] SpeedTrack gather_by_speed(const OrderTracks& tracks, DegPerSec step);

/// Width of speed ranges that cuts the speeds into about 24, 1, 2 or 5 times a power of ten, at least 1 % of
/// the highest speed; 1 when nothing moves.
[[nodiscard]] double speed_step(const SpeedSpan& speeds);

/// Rows that do not follow on the row before, since there are no data between: the joint reverses or is at
/// standstill, or the log has a gap. Rising, never 0; over speed those with an empty range before them.
[[nodiscard]] std::vector<std::size_t> track_breaks(const OrderTracks& tracks);
[[nodiscard]] std::vector<std::size_t> track_breaks(const SpeedTrack& tracks);

}  // namespace ripplenotch
