// SPDX-License-Identifier: MIT
#pragma once
// Spectra of many sweeps on one grid, against output angle or against time, each sweep normalized by its own
// noise before they are averaged. Order and time are treated alike so that they can be compared: a line
// belongs to the axis on which it has the higher SNR.

#include <cstddef>
#include <span>
#include <vector>

#include "ripplenotch/analysis/line_test.hpp"
#include "ripplenotch/analysis/sweeps.hpp"

namespace ripplenotch {

enum class Axis {
    angle,  ///< bins are output orders: cycles per output turn
    time,   ///< bins are hertz
};

struct Stack {
    Axis axis = Axis::angle;
    double spacing = 0.0;               ///< between bins, in orders or hertz
    double resolution = 0.0;            ///< 1.5 / weighted mean length of the sweeps: width of a Hann line
    std::vector<double> ratio;          ///< power over noise, weighted mean over sweeps: 1 is noise
    std::vector<double> averages;       ///< independent averages behind each bin; 0 where no sweep reaches
    std::vector<double> amplitude_nm;   ///< zero to peak, rms over sweeps
    std::vector<double> floor_nm;       ///< amplitude of noise alone, rms over sweeps
    std::vector<double> sweep_weights;  ///< effective samples
    std::vector<std::vector<float>> floors;  ///< per sweep and bin: mean noise power |S|^2; 0 where not used
    std::vector<char>
        removed;               ///< by bin, not 0 where a line was removed from the sweeps; see mark_removed()
    std::size_t first = 0;     ///< lowest bin in use
    std::size_t searched = 0;  ///< lowest bin at which lines are looked for
    double lowest = 0.0;       ///< the lowest order, or hertz, that is claimed to be searched

    [[nodiscard]] PowerSpectrum tested() const;
    /// States that the sweeps hold no line at a place, and no noise there.
    void mark_removed(double place);
    double tries_factor = 1.0;  ///< longest over mean length
};

struct StackRule {
    /// Per output turn. The lowest is an error once a turn; the highest is order 8 of a ratio of 320, the
    /// highest in catalogues.
    double lowest_order = 1.0, highest_order = 2560.0;
    double lowest_hz = 0.5;  ///< chosen, not derived
    /// A line has so many cycles in a sweep: its main lobe (two cycles to both sides) is then clear of the
    /// trend, which follows up to trend_cycles.
    double fewest_cycles = 4.0;
};

/// A sweep takes part up to half its sample rate at its slower speeds (lower quartile), beyond which lines
/// fold back. O(samples + sweeps * bins * log bins).
[[nodiscard]] Stack stack_sweeps(std::span<const Sweep> sweeps, Axis axis, const StackRule& rule);

/// The places of a sweep's samples on an axis: output turns, or seconds from its middle.
[[nodiscard]] std::span<const double> places(const Sweep& sweep, Axis axis);

/// Length of a sweep on an axis: turns or seconds.
[[nodiscard]] double length_of(const Sweep& sweep, Axis axis);

}  // namespace ripplenotch
