// SPDX-License-Identifier: MIT
#pragma once
// Internal to the analysis module: the evidence of the sweeps for one line at a position on an axis.

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "analysis/motion/sweep_fit.hpp"
#include "ripplenotch/analysis/line_search.hpp"

namespace ripplenotch {

/// Improvement in log-likelihood by one line at each bin: weighted sum over sweeps of power over noise, less
/// one each.
double gain_at(const Stack& stack, std::size_t bin);

/// Power over noise at a place, weighted mean over the sweeps, as Stack::ratio has it at its bins.
double mean_ratio(std::span<const Sweep> sweeps, const Stack& stack, double place);

/// Improvement in log-likelihood by a line (natural units): weighted sum over sweeps of power over noise,
/// less one each. Sweeps are weighted by their information, the best of them 1.
double gain_of(std::span<const Sweep> sweeps, const Stack& stack, double place);

/// A line on the axis of a stack; empty where none is there.
struct PlacedLine {
    const Stack& stack;
    std::optional<double> place;
};
/// Difference of the improvements in log-likelihood by two lines, and its standard error, since the noise
/// floor of each sweep is estimated from few cells, at each position independently. Sweeps in which both
/// explain the same, as where they are one and the same frequency, do not contribute.
struct GainDifference {
    double value = 0.0, error = 0.0;
};
GainDifference gain_difference(std::span<const Sweep> sweeps, const PlacedLine& one, const PlacedLine& other);

/// The same after another line is removed from each sweep with the amplitude and phase that it has there.
double gain_without(std::span<const Sweep> sweeps, const KnownLine& line, const Stack& stack, double place);

/// True when a line is seen even without the sweep that shows it best: a burst, or another joint's ripple
/// that passes by, fills one sweep. Where one sweep is most of the log, its halves count as two.
bool recurs(std::span<const Sweep> sweeps, const Stack& stack, double place);

/// The power over noise, alike in all sweeps, from which on a line recurs in 95 of 100 logs.
double recurring_ratio(std::span<const Sweep> sweeps, const Stack& stack, double place);

/// True when most of the motion shows a line as strong as the whole does, within a factor of ten in power:
/// images of unrelated lines meet at an order by chance, in some sweeps, and leave the others empty.
bool shown_throughout(std::span<const Sweep> sweeps, const Stack& stack, double place);

/// True when a frequency is seen at standstill, or in the slower half of the motion as well as in the faster
/// one, where those differ by more than the line is wide: at one speed an order looks the same as a tone, as
/// does the residual of an order at the speed that the motion lingers at.
bool at_two_speeds(std::span<const Sweep> sweeps, const Stack& time, double hz);

/// Place of the maximum of the summed power near a bin, all sweeps together, by Newton steps.
double refined(std::span<const Sweep> sweeps, const Stack& stack, std::size_t bin);

/// Fills in the results of the sweeps for a line at `place`.
void measure(std::span<const Sweep> sweeps, const Stack& stack, double place, MotionLine& line);

}  // namespace ripplenotch
