// SPDX-License-Identifier: MIT
#include "ripplenotch/log/timebase.hpp"

#include <algorithm>
#include <cmath>

namespace ripplenotch {

Timebase examine_timebase(const TraceView& trace, double gap_steps) {
    Timebase timebase;
    const auto& time = trace.time_s;
    if (time.size() < 2 || !std::isfinite(time.front())) return timebase;
    std::vector<double> steps(time.size() - 1);
    for (std::size_t i = 0; i + 1 < time.size(); ++i) steps[i] = time[i + 1] - time[i];
    std::vector<double> sorted = steps;
    const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
    std::nth_element(sorted.begin(), middle, sorted.end());
    timebase.median_step = Seconds(*middle);
    timebase.shortest_step = Seconds(*std::min_element(steps.begin(), steps.end()));
    timebase.longest_step = Seconds(*std::max_element(steps.begin(), steps.end()));
    double duration = 0.0;
    std::size_t counted = 0;
    for (std::size_t i = 0; i < steps.size(); ++i) {
        if (steps[i] == 0.0) ++timebase.repeated_times;
        if (*middle > 0.0 && steps[i] > gap_steps * *middle) {
            timebase.gaps.push_back({i, time[i], time[i + 1]});
            continue;
        }
        duration += steps[i];
        ++counted;
    }
    if (duration > 0.0) timebase.sample_rate = Hertz(static_cast<double>(counted) / duration);
    return timebase;
}

}  // namespace ripplenotch
