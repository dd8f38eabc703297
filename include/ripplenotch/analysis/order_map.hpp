// SPDX-License-Identifier: MIT
#pragma once
// Spectra over the output angle, stacked or against speed (order map), and frequency against speed (Campbell
// diagram), as numbers.

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "ripplenotch/analysis/sweeps.hpp"
#include "ripplenotch/core/trace.hpp"

namespace ripplenotch {

/// By bin, from `first` on; the order of a bin is its number times the spacing.
struct Stack {
    double spacing = 0.0;
    double resolution = 0.0;           ///< 1.5 / weighted mean length of the sweeps: width of a Hann line
    std::size_t first = 0;             ///< lowest bin in use
    std::vector<double> averages;      ///< independent averages; 0 where no sweep reaches
    std::vector<double> amplitude_nm;  ///< zero to peak, rms over sweeps
    std::vector<double> floor_nm;      ///< amplitude of noise alone, rms over sweeps
};

/// Each sweep that moves, less the trend of the ripple estimates, counts from three cycles in it to half its
/// sample rate, and by its information. O(samples + sweeps * bins * log bins).
[[nodiscard]] Stack stack_sweeps(std::span<const Sweep> sweeps);

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
