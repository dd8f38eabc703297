// SPDX-License-Identifier: MIT
#pragma once
// Spectra over speed: frequency against speed (Campbell diagram) and order against speed (order map), as
// numbers. Also the torque in a band of orders.

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "ripplenotch/analysis/stack.hpp"
#include "ripplenotch/core/trace.hpp"

namespace ripplenotch {

struct MapOptions {
    Axis axis = Axis::angle;  ///< angle: orders of the shaft given; time: hertz
    /// Wanted 1.5 / length of the windows, in orders or hertz; left out: windows of a sixteenth of the
    /// longest run, but at least 16 turns or 0.25 s (or a quarter of the run), and at most 64 turns or 2 s.
    std::optional<double> resolution = {};
    std::optional<double> highest =
        {};  ///< upper end of the axis; left out: half the sample rate at the highest speed
    DegPerSec speed_step{0.0};  ///< width of a speed's range; 0 chooses, as for tracks
};

/// amplitude_nm[s][k] belongs to speed_deg_s[s] and axis[k].
struct SpeedMap {
    Axis axis_kind = Axis::angle;
    std::vector<double> speed_deg_s;  ///< |speed|, mean of the windows gathered, slowest first
    std::vector<std::size_t> windows;
    std::vector<double> axis;  ///< orders or hertz, evenly spaced from 0
    std::vector<std::vector<double>>
        amplitude_nm;         ///< a line shows its amplitude, zero to peak; rms over windows
    double spacing = 0.0;     ///< spacing of the axis: a third of the resolution
    double resolution = 0.0;  ///< as obtained: 1.5 / length of the windows used
    double speed_step_deg_s = 0.0;
    std::size_t runs_too_short = 0;  ///< runs of motion shorter than a window
};

/// Windows of equal length in turns of `shaft_turns` (or in time), half overlapping, within runs of one
/// direction; Hann window in angle, each sample weighted by the angle it represents, no interpolation; the
/// trend of the ripple estimates removed. A window belongs to its mean speed. When no run is as long as the
/// requested resolution needs, the longest run is one window and `resolution` reports it. `shaft_turns` and
/// `speed_deg_s` have one value a sample. Throws DataError for a log without motion. O(n + windows * bins log
/// bins).
[[nodiscard]] SpeedMap speed_map(const TraceView& log, std::span<const double> shaft_turns,
                                 std::span<const double> speed_deg_s, const MapOptions& options);

}  // namespace ripplenotch
