// SPDX-License-Identifier: MIT
#pragma once
// Order tracks against speed instead of time.

#include "ripplenotch/analysis/order_track.hpp"
#include "ripplenotch/core/speed_span.hpp"

namespace ripplenotch {

/// Rows of tracks gathered by signed speed. All vectors have one value a speed, slowest (most negative)
/// first.
struct SpeedTrack {
    std::vector<double> speed_deg_s;  ///< mean of the rows gathered
    std::vector<std::size_t> rows;    ///< how many
    struct Line {
        std::vector<double> amplitude_nm;  ///< zero to peak, mean of the rows
        /// Standard deviation of the rows' amplitudes; with one row, its own standard error.
        std::vector<double> spread_nm;
        std::vector<double> phase_deg;  ///< of the mean of all rows, each an arrow of its amplitude and phase
        std::vector<double> hz;         ///< mean
    };
    std::vector<Line> lines;  ///< nan where no row of that speed has the line
    double step_deg_s = 0.0;  ///< width of a speed's range, as used
};

/// A step of 0 takes speed_step of the speeds that occur. Ranges without a row are left out.
[[nodiscard]] SpeedTrack gather_by_speed(const OrderTracks& tracks, DegPerSec step);

/// Width of speed ranges that cuts the speeds into about 24, 1, 2 or 5 times a power of ten, at least 1 % of
/// the highest speed; 1 when nothing moves.
[[nodiscard]] double speed_step(const SpeedSpan& speeds);

}  // namespace ripplenotch
