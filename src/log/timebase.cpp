// SPDX-License-Identifier: MIT
#include "ripplenotch/log/timebase.hpp"

#include <algorithm>
#include <cmath>

#include "log/clock_check.hpp"
#include "log/timebase_warnings.hpp"

namespace ripplenotch {
namespace {

double median_of(std::vector<double> values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

// The usual step. A clock coarser than the rows repeats itself: then the steps that do advance are shared
// out.
double usual_step(const std::vector<double>& steps) {
    const double median = median_of(steps);
    if (median > 0.0) return median;
    std::vector<double> advancing;
    std::copy_if(steps.begin(), steps.end(), std::back_inserter(advancing),
                 [](double step) { return step > 0.0; });
    return advancing.empty() ? 0.0 : median_of(std::move(advancing));
}

/// Returns the longest step that is no gap; 0 when there is no such limit.
double measure_steps(std::span<const double> time, double gap_steps, Timebase& timebase) {
    std::vector<double> steps(time.size() - 1);
    for (std::size_t i = 0; i < steps.size(); ++i) steps[i] = time[i + 1] - time[i];
    const auto [shortest, longest] = std::minmax_element(steps.begin(), steps.end());
    timebase.median_step = Seconds(median_of(steps));
    timebase.shortest_step = Seconds(*shortest);
    timebase.longest_step = Seconds(*longest);
    const double limit = gap_steps * usual_step(steps);
    double duration = 0.0;
    std::size_t counted = 0;
    for (std::size_t i = 0; i < steps.size(); ++i) {
        timebase.repeated_times += steps[i] == 0.0;
        if (limit > 0.0 && steps[i] > limit) {
            timebase.gaps.push_back({i, time[i], time[i + 1]});
            continue;
        }
        duration += steps[i];
        ++counted;
    }
    if (!(duration > 0.0)) return limit;
    const double mean = duration / static_cast<double>(counted);
    timebase.sample_rate = Hertz(1.0 / mean);
    double square = 0.0;
    for (const double step : steps) {
        if (!(limit > 0.0 && step > limit)) square += (step - mean) * (step - mean);
    }
    timebase.jitter = Seconds(std::sqrt(square / static_cast<double>(counted)));
    return limit;
}

}  // namespace

Timebase examine_steps(std::span<const double> time_s, double gap_steps) {
    Timebase timebase;
    if (time_s.size() >= 2 && std::isfinite(time_s.front())) measure_steps(time_s, gap_steps, timebase);
    return timebase;
}

Timebase examine_timebase(const TraceView& trace, double gap_steps) {
    Timebase timebase;
    if (trace.size() < 2) return timebase;
    const bool timed = std::isfinite(trace.time_s.front());
    const double limit = timed ? measure_steps(trace.time_s, gap_steps, timebase) : 0.0;
    ClockTroubles troubles{trace.size(), 0, timebase.repeated_times, {}, count_held(trace)};
    for (const Gap& gap : timebase.gaps) troubles.add_gap(gap);
    timebase.held_samples = troubles.held.count;
    timebase.longest_hold = troubles.held.longest;
    timebase.warnings = timebase_warnings(troubles);
    if (timed && std::isfinite(trace.velocity_deg_s.front())) {
        ClockCheck check = check_clock(trace, limit, timebase.sample_rate);
        timebase.clock_factor = check.factor;
        if (!check.warning.empty()) timebase.warnings.push_back(std::move(check.warning));
    }
    return timebase;
}

}  // namespace ripplenotch
