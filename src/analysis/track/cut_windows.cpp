// SPDX-License-Identifier: MIT
#include "analysis/track/cut_windows.hpp"

#include <algorithm>
#include <cmath>

namespace ripplenotch {

std::vector<SampleRun> cut_windows(const SampleRun& run, std::span<const double> place, double length,
                                   double shortest, double hop) {
    const double start = place[run.first];
    const double whole = std::abs(place[run.end - 1] - start);
    if (whole < shortest) return {};
    if (whole <= length) return {run};
    // No more windows than samples, however far apart those are.
    const double hops =
        std::min(std::ceil((whole - length) / (hop * length)), static_cast<double>(run.size()));
    std::vector<SampleRun> windows;
    std::size_t from = run.first, to = run.first;
    for (double i = 0.0; i <= hops; i += 1.0) {
        const double begin = (whole - length) * i / hops;
        while (from < run.end && std::abs(place[from] - start) < begin) ++from;
        to = std::max(to, from);
        while (to < run.end && std::abs(place[to] - start) <= begin + length) ++to;
        windows.push_back({from, to});
    }
    return windows;
}

}  // namespace ripplenotch
