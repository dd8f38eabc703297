// SPDX-License-Identifier: MIT
#pragma once
#include <span>
#include <vector>

#include "ripplenotch/analysis/stack.hpp"
#include "ripplenotch/analysis/sweeps.hpp"

namespace ripplenotch {

// Internal to the analysis module: known components of a sweep's torque, its smooth part and lines, removed
// from it.

struct KnownLine {
    Axis axis = Axis::angle;
    double place = 0.0;  ///< cycles per turn or per second
};

/// Sets the sweep's torque, and its value, to the residual of the measured torque after the smooth part and
/// the lines: all of them fitted at once, by least squares under the weights. Cost O(n (terms + 2 lines)^2).
void fit_out(Sweep& sweep, std::span<const KnownLine> lines);

/// The sweep without what least squares finds of a line in it, nothing else fitted anew.
[[nodiscard]] Sweep without_line(Sweep sweep, const KnownLine& line);

/// Removes the last of the lines, those before it being removed. A sweep of few cycles cannot separate a line
/// from its smooth part, nor from a line near by, when one is fitted after the other: there all are fitted at
/// once. What would remain otherwise stands at the frequency that the line has where the sweep is fastest, a
/// fixed one.
void remove_last(std::vector<Sweep>& sweeps, std::span<const KnownLine> lines);

/// Sweeps from which all lines were removed, with one of them left in: what only it explains is in them then.
[[nodiscard]] std::vector<Sweep> with_line(std::vector<Sweep> sweeps, std::span<const KnownLine> lines,
                                           std::size_t restored);

/// True where two lines do not stand for each other in any sweep.
[[nodiscard]] bool apart(std::span<const Sweep> sweeps, const KnownLine& one, const KnownLine& other);

}  // namespace ripplenotch
