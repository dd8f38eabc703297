// SPDX-License-Identifier: MIT
#pragma once
// The spectrum over the output angle: sums over each sweep, stacked.

#include <cstddef>
#include <span>
#include <vector>

#include "ripplenotch/analysis/sweeps.hpp"

namespace ripplenotch {

enum class Axis {
    angle,  ///< places are output orders: cycles per output turn
    time,   ///< places are hertz
};

/// By bin, from `first` on; the order of a bin is its number times the spacing.
struct Stack {
    double spacing = 0.0;
    double resolution = 0.0;           ///< 1.5 / weighted mean length of the sweeps: width of a Hann line
    std::size_t first = 0;             ///< lowest bin in use
    std::vector<double> averages;      ///< independent averages; 0 where no sweep reaches
    std::vector<double> amplitude_nm;  ///< zero to peak, rms over sweeps
    std::vector<double> floor_nm;      ///< amplitude of noise alone, rms over sweeps
};

/// Each sweep that moves counts from three cycles in it, which its trend leaves, to half its sample rate, and
/// by its information. O(samples + sweeps * bins * log bins).
[[nodiscard]] Stack stack_sweeps(std::span<const Sweep> sweeps);

/// The places of a sweep's samples on an axis: output turns, or seconds from its middle.
[[nodiscard]] inline std::span<const double> places(const Sweep& sweep, Axis axis) {
    return axis == Axis::angle ? sweep.turns : sweep.time_s;
}

/// Length of a sweep on an axis: turns or seconds.
[[nodiscard]] inline double length_of(const Sweep& sweep, Axis axis) {
    return axis == Axis::angle ? sweep.length_turns : sweep.duration_s;
}

}  // namespace ripplenotch
