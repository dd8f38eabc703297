// SPDX-License-Identifier: MIT
#pragma once
#include <span>
#include <vector>

namespace ripplenotch {

// Logs that lost rows here and there: an effect that uses earlier samples, a delay or a lag, has to know
// which of them is missing.

/// Position of each sample on a clock without gaps, in samples from the first: whole numbers that increase.
/// Empty where no row is missing. Single stamps may be off by nearly half a step: the clock common to all
/// stamps decides. A gap of more than a few samples does not count as lost rows and is one step, as
/// everywhere. `step_s` is set to the step of that clock.
[[nodiscard]] std::vector<std::size_t> places_of_rows(std::span<const double> time_s, double& step_s);

/// A signal known at these positions as one at every position: missing samples are on the cubic through two
/// samples to each side.
[[nodiscard]] std::vector<double> with_lost_rows(std::span<const double> values,
                                                 std::span<const std::size_t> places);

/// Runs act(values, sample rate in Hz) on a signal along these times, with lost rows filled in.
template <class Act>
void on_whole_clock(std::span<const double> time_s, double mean_rate_hz, std::span<double> values,
                    const Act& act) {
    double step_s = 0.0;
    const std::vector<std::size_t> places = places_of_rows(time_s, step_s);
    if (places.empty()) {
        act(values, mean_rate_hz);
        return;
    }
    std::vector<double> whole = with_lost_rows(values, places);
    act(std::span<double>(whole), 1.0 / step_s);
    for (std::size_t k = 0; k < values.size(); ++k) values[k] = whole[places[k]];
}

}  // namespace ripplenotch
