// SPDX-License-Identifier: MIT
#include "ripplenotch/analysis/order_map.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <map>
#include <numbers>

#include "analysis/track/window_fit.hpp"
#include "ripplenotch/analysis/fourier.hpp"
#include "ripplenotch/analysis/line_test.hpp"
#include "ripplenotch/analysis/order_track.hpp"
#include "ripplenotch/analysis/sweeps.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {

namespace {

constexpr double used_cycles = 3.0;  // in a sweep: twice what the trend follows
// Half-overlapping Hann pieces count a little less than independent ones.
constexpr double overlap_correlation = 1.06;
constexpr double highest_stacked_order = 2560.0;      // order 8 of a ratio of 320, the highest in catalogues
constexpr double bins_per_resolution = 3.0;           // chosen, not derived
constexpr std::size_t fewest_samples_of_window = 32;  // chosen, not derived
constexpr double window_share = 1.0 / 16.0;           ///< share of the longest run

double default_length(Axis axis, double longest) {
    const double least = axis == Axis::angle ? 16.0 : 0.25, most = axis == Axis::angle ? 64.0 : 2.0;
    return std::clamp(window_share * longest, std::min(least, 0.25 * longest), most);
}

/// Squared amplitudes at multiples of a spacing of a torque under a window, less the trend of every ripple
/// estimate; empty where nothing counts.
std::vector<double> powers_of(std::span<const double> place, std::span<const double> root_weight,
                              std::span<const double> torque_nm, double spacing, std::size_t bins) {
    WindowFit fit(place, root_weight, 0.0, {}, 0);
    if (!(fit.weight() > 0.0)) return {};
    fit.factorise();
    std::vector<double> value = fit.fit(torque_nm).residual, where, powers;
    for (std::size_t k = 0; k < value.size(); ++k) {
        value[k] *= root_weight[k];
        where.push_back(place[k] - place.front());
    }
    for (const std::complex<double>& sum : nonuniform_fourier(where, value, spacing, bins))
        powers.push_back((powers.empty() ? 1.0 : 4.0) * std::norm(sum) / (fit.weight() * fit.weight()));
    return powers;
}

/// Of a window of a map: a Hann window along its places, in which each sample counts as much of the axis as
/// it stands for.
std::vector<double> powers_of(const TraceView& log, const SampleRun& run, std::span<const double> all_places,
                              double spacing, std::size_t bins) {
    const auto place = all_places.subspan(run.first, run.size());
    const auto time_s = log.time_s.subspan(run.first, run.size());
    const double longest_s =
        3.0 / log.sample_rate.value();  // a lost stretch is not the business of one sample
    std::vector<double> root_weight;
    for (std::size_t k = 0; k < place.size(); ++k) {
        const std::size_t before = k > 0 ? k - 1 : k, after = std::min(k + 1, place.size() - 1);
        const double seconds = std::max(time_s[after] - time_s[before], 1e-12);
        const double share =
            std::abs(place[after] - place[before]) * std::min(1.0, 2.0 * longest_s / seconds);
        const double u = std::clamp((place[k] - place.front()) / (place.back() - place.front()), 0.0, 1.0);
        root_weight.push_back(portable::sin(std::numbers::pi * u) * std::sqrt(share));
    }
    return powers_of(place, root_weight, log.torque_nm.subspan(run.first, run.size()), spacing, bins);
}

struct Gathered {
    double speed_sum = 0.0;
    std::size_t windows = 0;
    std::vector<double> power;  ///< sum of squared amplitudes
};

double mean_speed(std::span<const double> speed, const SampleRun& run) {
    double sum = 0.0;
    for (std::size_t k = run.first; k < run.end; ++k) sum += std::abs(speed[k]);
    return sum / static_cast<double>(run.size());
}

/// The windows of all runs, of one length, which is set: the requested one, or the longest run when that is
/// shorter.
std::vector<SampleRun> cut(const std::vector<SampleRun>& runs, std::span<const double> place,
                           const MapOptions& options, double& length, std::size_t& too_short) {
    double longest = 0.0;
    for (const SampleRun& run : runs) {
        if (run.size() >= fewest_samples_of_window)
            longest = std::max(longest, std::abs(place[run.end - 1] - place[run.first]));
    }
    if (!(longest > 0.0)) raise<DataError>("the joint does not move: there is no speed to map over");
    const double wanted =
        options.resolution ? hann_cell / *options.resolution : default_length(options.axis, longest);
    length = std::min(wanted, longest);
    std::vector<SampleRun> windows;
    for (const SampleRun& run : runs) {
        const auto found = cut_windows(run, place, length, length * (1.0 - 1e-9), 0.5);
        if (found.empty()) ++too_short;
        for (const SampleRun& window : found) {
            if (window.size() >= fewest_samples_of_window) windows.push_back(window);
        }
    }
    return windows;
}

}  // namespace

Stack stack_sweeps(std::span<const Sweep> sweeps) {
    Stack stack;
    double longest = 0.0, weights = 0.0, lengths = 0.0, highest = 0.0;
    const auto top = [](const Sweep& sweep) {
        return std::min(highest_stacked_order, 180.0 * sweep.rate_hz / std::max(sweep.fast_deg_s, 1e-9));
    };
    for (const Sweep& sweep : sweeps) {
        if (sweep.rest()) continue;
        longest = std::max(longest, sweep.length_turns);
        weights += sweep.effective_samples();
        lengths += sweep.effective_samples() * sweep.length_turns;
        highest = std::max(highest, top(sweep));
    }
    if (!(longest > 0.0)) return stack;
    stack.spacing = 0.5 / longest;
    stack.resolution = hann_cell * weights / lengths;
    const auto bins = static_cast<std::size_t>(highest / stack.spacing) + 1;
    stack.first = bins;
    std::vector<double> weight(bins, 0.0), square = weight, power = weight, noise = weight;
    for (const Sweep& sweep : sweeps) {
        if (sweep.rest()) continue;
        const double cells = 1.0 / (sweep.length_turns * stack.spacing), own = sweep.effective_samples();
        const auto from = static_cast<std::size_t>(std::ceil(used_cycles * cells));
        const auto end = std::min(static_cast<std::size_t>(top(sweep) / stack.spacing) + 1, bins);
        if (from + 1 >= end || !(sweep.weight_sum > 0.0)) continue;
        std::vector<double> root_weight;
        for (const double one : sweep.weight) root_weight.push_back(std::sqrt(one));
        const std::vector<double> powers =
            powers_of(sweep.turns, root_weight, sweep.measured_nm, stack.spacing, end);
        const std::vector<double> floor = noise_floor({powers, 1.0, hann_cell * cells, from});
        for (std::size_t k = from; k < end; ++k) {
            weight[k] += own;
            square[k] += own * own;
            power[k] += own * powers[k];
            noise[k] += own * floor[k];
        }
        stack.first = std::min(stack.first, from);
    }
    for (std::size_t k = 0; k < bins; ++k) {
        const double sum = std::max(weight[k], 1e-300);
        const bool seen = weight[k] > 0.0;
        stack.averages.push_back(seen ? std::max(1.0, sum * sum / square[k] / overlap_correlation) : 0.0);
        stack.amplitude_nm.push_back(std::sqrt(power[k] / sum));
        stack.floor_nm.push_back(std::sqrt(noise[k] / sum));
    }
    return stack;
}

SpeedMap speed_map(const TraceView& log, std::span<const double> shaft_turns,
                   std::span<const double> speed_deg_s, const MapOptions& options) {
    if (options.resolution && !(*options.resolution > 0.0)) raise<UsageError>("a resolution must be above 0");
    const bool angle = options.axis == Axis::angle;
    const auto place = angle ? shaft_turns : log.time_s;
    SpeedMap map;
    map.axis_kind = options.axis;
    double length = 0.0;
    const auto runs = directed_runs(speed_deg_s, log.run_starts, {});
    const std::vector<SampleRun> windows = cut(runs, place, options, length, map.runs_too_short);
    if (windows.empty())
        raise<DataError>("no window of the map holds {} samples; use a finer resolution",
                         fewest_samples_of_window);
    map.resolution = hann_cell / length;
    map.spacing = map.resolution / bins_per_resolution;

    std::vector<double> speeds;
    double fastest_rate = 0.0;  // turns per second in the fastest window
    for (const SampleRun& window : windows) {
        speeds.push_back(mean_speed(speed_deg_s, window));
        const double seconds = log.time_s[window.end - 1] - log.time_s[window.first];
        const double rate = std::abs(shaft_turns[window.end - 1] - shaft_turns[window.first]) / seconds;
        fastest_rate = std::max(fastest_rate, rate);
    }
    const double half_rate = 0.5 * log.sample_rate.value();
    const double highest = options.highest.value_or(angle ? half_rate / fastest_rate : half_rate);
    const auto bins = static_cast<std::size_t>(highest / map.spacing) + 1;
    const auto [low, high] = std::minmax_element(speeds.begin(), speeds.end());
    map.speed_step_deg_s = options.speed_step.value() > 0.0 ? options.speed_step.value()
                                                            : speed_step({DegPerSec(*low), DegPerSec(*high)});

    std::map<long long, Gathered> rows;
    for (std::size_t i = 0; i < windows.size(); ++i) {
        const std::vector<double> powers = powers_of(log, windows[i], place, map.spacing, bins);
        if (powers.empty()) continue;
        Gathered& row = rows[std::llround(speeds[i] / map.speed_step_deg_s)];
        row.power.resize(bins, 0.0);
        row.speed_sum += speeds[i];
        ++row.windows;
        for (std::size_t k = 0; k < bins; ++k) row.power[k] += powers[k];
    }
    for (auto& [range, row] : rows) {
        const double n = static_cast<double>(row.windows);
        map.speed_deg_s.push_back(row.speed_sum / n);
        map.windows.push_back(row.windows);
        for (double& power : row.power) power = std::sqrt(power / n);
        map.amplitude_nm.push_back(std::move(row.power));
    }
    for (std::size_t k = 0; k < bins; ++k) map.axis.push_back(map.spacing * static_cast<double>(k));
    return map;
}

}  // namespace ripplenotch
