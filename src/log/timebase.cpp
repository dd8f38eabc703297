// SPDX-License-Identifier: MIT
#include "ripplenotch/log/timebase.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "log/clock_check.hpp"
#include "log/held_samples.hpp"

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

void examine_steps(const TraceView& trace, double gap_steps, Timebase& timebase) {
    const auto& time = trace.time_s;
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
    if (!(duration > 0.0)) return;
    const double mean = duration / static_cast<double>(counted);
    timebase.sample_rate = Hertz(1.0 / mean);
    double square = 0.0;
    for (const double step : steps) {
        if (!(limit > 0.0 && step > limit)) square += (step - mean) * (step - mean);
    }
    timebase.jitter = Seconds(std::sqrt(square / static_cast<double>(counted)));
}

void warn(const TraceView& trace, Timebase& timebase) {
    const auto percent = [&](std::size_t count) {
        return 100.0 * static_cast<double>(count) / static_cast<double>(trace.size());
    };
    if (!timebase.gaps.empty()) {
        const auto longest = std::max_element(
            timebase.gaps.begin(), timebase.gaps.end(),
            [](const Gap& a, const Gap& b) { return a.to_s - a.from_s < b.to_s - b.from_s; });
        timebase.warnings.push_back(
            fmt::format("{} {} in the time, the longest of {:.4g} s after {:.9g} s; each starts a new run",
                        timebase.gaps.size(), timebase.gaps.size() == 1 ? "gap" : "gaps",
                        longest->to_s - longest->from_s, longest->from_s));
    }
    if (timebase.repeated_times > 0) {
        timebase.warnings.push_back(
            fmt::format("{} rows ({:.2g} %) repeat the time of the row before: the clock is coarser "
                        "than the rows, or rows were doubled",
                        timebase.repeated_times, percent(timebase.repeated_times)));
    }
    if (timebase.held_samples > 0 && percent(timebase.held_samples) >= 0.1) {
        timebase.warnings.push_back(
            fmt::format("{} rows ({:.2g} %) hold the sample before while the joint moves, up to {} in a row",
                        timebase.held_samples, percent(timebase.held_samples), timebase.longest_hold));
    }
}

}  // namespace

Timebase examine_timebase(const TraceView& trace, double gap_steps) {
    Timebase timebase;
    if (trace.size() < 2) return timebase;
    const bool timed = std::isfinite(trace.time_s.front());
    if (timed) examine_steps(trace, gap_steps, timebase);
    const HeldSamples held = count_held(trace);
    timebase.held_samples = held.count;
    timebase.longest_hold = held.longest;
    warn(trace, timebase);
    if (timed && std::isfinite(trace.velocity_deg_s.front())) {
        std::vector<std::size_t> breaks;
        for (const Gap& gap : timebase.gaps) breaks.push_back(gap.row);
        ClockCheck check = check_clock(trace, breaks, timebase.sample_rate);
        timebase.clock_factor = check.factor;
        if (!check.warning.empty()) timebase.warnings.push_back(std::move(check.warning));
    }
    return timebase;
}

}  // namespace ripplenotch
