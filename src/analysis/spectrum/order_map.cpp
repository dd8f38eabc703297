// SPDX-License-Identifier: MIT
#include "ripplenotch/analysis/order_map.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>

#include "core/matrices/factorisations.hpp"
#include "ripplenotch/analysis/fourier.hpp"
#include "ripplenotch/analysis/order_track.hpp"
#include "ripplenotch/analysis/sweeps.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {

namespace {

// Number of terms of the polynomial trend that is removed from a window: a cubic, since a quadratic leaks
// into order 2 where a joint reverses.
constexpr std::ptrdiff_t window_trend_terms = 4;

constexpr double bins_per_resolution = 3.0;           // chosen, not derived
constexpr std::size_t fewest_samples_of_window = 32;  // chosen, not derived
constexpr double window_share = 1.0 / 16.0;           ///< share of the longest run

double default_length(Axis axis, double longest) {
    const double least = axis == Axis::angle ? 16.0 : 0.25, most = axis == Axis::angle ? 64.0 : 2.0;
    return std::clamp(window_share * longest, std::min(least, 0.25 * longest), most);
}

std::vector<SampleRun> half_overlapping(const SampleRun& run, std::span<const double> place, double length) {
    const double start = place[run.first];
    const double whole = std::abs(place[run.end - 1] - start);
    if (whole < length * (1.0 - 1e-9)) return {};
    // No more windows than samples, however far apart those are.
    const double hops = std::min(std::ceil(2.0 * (whole - length) / length), static_cast<double>(run.size()));
    std::vector<SampleRun> windows;
    std::size_t from = run.first, to = run.first;
    for (double i = 0.0; i <= hops; i += 1.0) {
        const double begin = hops > 0.0 ? (whole - length) * i / hops : 0.0;
        while (from < run.end && std::abs(place[from] - start) < begin) ++from;
        to = std::max(to, from);
        while (to < run.end && std::abs(place[to] - start) <= begin + length * (1.0 + 1e-9)) ++to;
        windows.push_back({from, to});
    }
    return windows;
}

/// One window: places from its start, Hann weights that count how much of the axis a sample stands for.
struct MapWindow {
    std::vector<double> where, weight, value;
    double weight_sum = 0.0;
};

/// A cubic under the window's own weights: at its edges, where it matters least, it fits least.
void remove_cubic(MapWindow& window, std::span<const double> torque) {
    const double length = std::abs(window.where.back() - window.where.front());
    Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
    Eigen::Vector4d right = Eigen::Vector4d::Zero(), row;
    const auto fill = [&](std::size_t k) {
        const double s = 2.0 * std::abs(window.where[k] - window.where.front()) / length - 1.0;
        double power = 1.0;
        for (Eigen::Index i = 0; i < window_trend_terms; ++i, power *= s) row[i] = power;
    };
    for (std::size_t k = 0; k < torque.size(); ++k) {
        fill(k);
        normal += window.weight[k] * row * row.transpose();
        right += window.weight[k] * torque[k] * row;
    }
    const Eigen::Vector4d trend = SymmetricFactors(normal).solve(Eigen::VectorXd(right));
    window.value.resize(torque.size());
    for (std::size_t k = 0; k < torque.size(); ++k) {
        fill(k);
        window.value[k] = window.weight[k] * (torque[k] - trend.dot(row));
    }
}

MapWindow make_window(const TraceView& log, const SampleRun& run, std::span<const double> place,
                      std::span<const double> torque) {
    MapWindow window;
    const std::size_t n = run.size();
    const double start = place[run.first], length = place[run.end - 1] - start;
    window.where.resize(n);
    window.weight.resize(n);
    const double most = 3.0 / log.sample_rate.value();  // a lost stretch is not the business of one sample
    for (std::size_t k = 0; k < n; ++k) {
        const std::size_t at = run.first + k;
        const std::size_t before = k > 0 ? at - 1 : at, after = k + 1 < n ? at + 1 : at;
        const double u = std::clamp((place[at] - start) / length, 0.0, 1.0);
        const double seconds = log.time_s[after] - log.time_s[before];
        const double share =
            std::abs(place[after] - place[before]) * std::min(1.0, 2.0 * most / std::max(seconds, 1e-12));
        window.where[k] = place[at] - start;
        window.weight[k] = (0.5 - 0.5 * portable::cos(2.0 * std::numbers::pi * u)) * share;
        window.weight_sum += window.weight[k];
    }
    if (window.weight_sum > 0.0) remove_cubic(window, torque.subspan(run.first, n));
    return window;
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
        const auto found = half_overlapping(run, place, length);
        if (found.empty()) ++too_short;
        for (const SampleRun& window : found) {
            if (window.size() >= fewest_samples_of_window) windows.push_back(window);
        }
    }
    return windows;
}

}  // namespace

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
        const MapWindow window = make_window(log, windows[i], place, log.torque_nm);
        if (!(window.weight_sum > 0.0)) continue;
        Gathered& row = rows[std::llround(speeds[i] / map.speed_step_deg_s)];
        row.power.resize(bins, 0.0);
        row.speed_sum += speeds[i];
        ++row.windows;
        const auto sums = nonuniform_fourier(window.where, window.value, map.spacing, bins);
        for (std::size_t k = 0; k < bins; ++k) {
            const double amplitude = (k == 0 ? 1.0 : 2.0) * std::abs(sums[k]) / window.weight_sum;
            row.power[k] += amplitude * amplitude;
        }
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
