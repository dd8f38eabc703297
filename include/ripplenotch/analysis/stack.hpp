// SPDX-License-Identifier: MIT
#pragma once
// Spectra of many sweeps on one grid, against output angle or against time, each sweep normalized by its own
// noise before they are averaged.

#include <cstddef>
#include <span>
#include <vector>

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
    std::size_t first = 0;                   ///< lowest bin in use
};

struct StackRule {
    /// Per output turn: order 8 of a ratio of 320, the highest in catalogues.
    double highest_order = 2560.0;
};

/// A sweep takes part up to half its sample rate at its slower speeds (lower quartile), beyond which lines
/// fold back. O(samples + sweeps * bins * log bins).
[[nodiscard]] Stack stack_sweeps(std::span<const Sweep> sweeps, Axis axis, const StackRule& rule);

/// The places of a sweep's samples on an axis: output turns, or seconds from its middle.
[[nodiscard]] std::span<const double> places(const Sweep& sweep, Axis axis);

/// Length of a sweep on an axis: turns or seconds.
[[nodiscard]] double length_of(const Sweep& sweep, Axis axis);

}  // namespace ripplenotch
