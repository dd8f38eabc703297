// SPDX-License-Identifier: MIT
#include "ripplenotch/analysis/order_track.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <map>
#include <utility>

#include "analysis/track/window_fit.hpp"
#include "core/vectors/dot.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {

namespace {

/// Smallest pivot of the normal equations with unit columns. Below, a line is collinear with the others, to
/// within rounding times the torque's range.
constexpr double least_pivot = 1e-9;

void check_signal(const TrackedSignal& signal, const WindowRule& rule) {
    if (signal.lines.empty()) raise<UsageError>("there is no order to track");
    for (const TrackedLine& line : signal.lines) {
        if (!(line.order > 0.0)) raise<UsageError>("order {} is not above 0", shortest(line.order));
    }
    if (rule.seconds.value() < 0.0 || (rule.seconds.value() == 0.0 && !(rule.turns > 0.0))) {
        raise<UsageError>("a window of {} turns is not above 0", shortest(rule.turns));
    }
    if (!(rule.hop > 0.0) || rule.hop > 1.0 || rule.envelope_degree < 0 || rule.envelope_degree > 2) {
        raise<UsageError>("windows are 0 to 1 length apart and their envelopes of degree 0 to 2");
    }
}

void add_row(const TrackedSignal& signal, const SampleRun& window, OrderTracks& tracks) {
    const auto times = signal.time_s.subspan(window.first, window.size());
    const double middle_s = 0.5 * (times.front() + times.back());
    const auto nearest = std::lower_bound(times.begin(), times.end(), middle_s) - times.begin();
    tracks.time_s.push_back(middle_s);
    tracks.speed_deg_s.push_back(signal.speed_deg_s[window.first + static_cast<std::size_t>(nearest)]);
    const double duration_s = times.back() - times.front();
    bool folded = false;
    for (std::size_t i = 0; i < signal.lines.size(); ++i) {
        const TrackedLine& line = signal.lines[i];
        const double hz =
            line.order * std::abs(line.turns[window.end - 1] - line.turns[window.first]) / duration_s;
        tracks.lines[i].hz.push_back(hz);
        folded = folded || hz > 0.5 * signal.sample_rate.value();
    }
    tracks.rows_folded += folded ? 1 : 0;
}

/// Amplitude, phase and error of each line, from the variance of the residual.
void add_amplitudes(const WindowFit& fit, const WindowFit::Torque& torque, double variance,
                    OrderTracks& tracks) {
    for (std::size_t i = 0; i < tracks.lines.size(); ++i) {
        const std::complex<double> found = fit.amplitude(torque, i);
        const double amplitude = std::abs(found);
        const std::complex<double> along = amplitude > 0.0 ? found / amplitude : 1.0;
        tracks.lines[i].amplitude_nm.push_back(amplitude);
        tracks.lines[i].standard_error_nm.push_back(
            std::sqrt(std::max(variance * fit.variance(i, along), 0.0)));
        tracks.lines[i].phase_deg.push_back(portable::arg(found) * degrees_per_radian);
    }
}

constexpr double ranges_wanted = 24.0;  // chosen, not derived: rows that a person reads
constexpr double finest_share =
    0.01;  ///< share of the highest speed: a steady log is not cut up by its speed noise

void gather_line(const LineTrack& track, const std::vector<std::size_t>& rows, SpeedTrack::Line& line) {
    double sum = 0.0, square = 0.0, hz = 0.0, error = not_a_number;
    std::complex<double> arrow;
    std::size_t count = 0;
    for (const std::size_t row : rows) {
        const double amplitude = track.amplitude_nm[row];
        if (!std::isfinite(amplitude)) continue;
        ++count;
        sum += amplitude;
        square += amplitude * amplitude;
        hz += track.hz[row];
        error = track.standard_error_nm[row];
        arrow += portable::polar(amplitude, track.phase_deg[row] / degrees_per_radian);
    }
    const double n = static_cast<double>(count);
    const double mean = count > 0 ? sum / n : not_a_number;
    const double variance = count > 1 ? std::max(0.0, (square - sum * mean) / (n - 1.0)) : error * error;
    line.amplitude_nm.push_back(mean);
    line.spread_nm.push_back(std::sqrt(variance));
    line.phase_deg.push_back(count > 0 ? portable::arg(arrow) * degrees_per_radian : not_a_number);
    line.hz.push_back(count > 0 ? hz / n : not_a_number);
}

// A step so much longer than its neighbours holds no data: windows grow and shrink with the speed, but
// slowly.
constexpr double longest_step = 3.0;

}  // namespace

double separating_window_turns(std::span<const double> orders) {
    // Chosen, not derived: periods of the lowest line, and of the slowest beat.
    constexpr double periods = 8.0, beats = 2.0;
    std::vector<double> sorted(orders.begin(), orders.end());
    std::sort(sorted.begin(), sorted.end());
    if (sorted.empty() || !(sorted.front() > 0.0)) raise<UsageError>("orders must be above 0");
    double turns = periods / sorted.front();
    for (std::size_t i = 1; i < sorted.size(); ++i) {
        if (sorted[i] == sorted[i - 1]) raise<UsageError>("order {} is listed twice", shortest(sorted[i]));
        turns = std::max(turns, beats / (sorted[i] - sorted[i - 1]));
    }
    return turns;
}

OrderTracks track_orders(const TrackedSignal& signal, const WindowRule& rule) {
    check_signal(signal, rule);
    OrderTracks tracks;
    tracks.lines.resize(signal.lines.size());
    const bool by_time = rule.seconds.value() > 0.0;
    const auto place = by_time ? signal.time_s : signal.reference_turns;
    const double length = by_time ? rule.seconds.value() : rule.turns;
    double squares = 0.0;
    std::size_t freedom = 0;
    for (const SampleRun& run : directed_runs(signal.speed_deg_s, signal.run_starts, {})) {
        for (const SampleRun& window : cut_windows(run, place, length, 0.5 * length, rule.hop)) {
            const auto part = [&](std::span<const double> all) {
                return all.subspan(window.first, window.size());
            };
            if (window.size() < 2) continue;
            const auto reference = part(signal.reference_turns);
            std::vector<TrackedLine> lines;
            for (const TrackedLine& line : signal.lines) lines.push_back({line.order, part(line.turns)});
            WindowFit fit(part(signal.time_s), {},
                          std::abs(reference.back() - reference.front()) / signal.ratio.value(),
                          std::move(lines), rule.envelope_degree, WindowFit::Trend::polynomials);
            if (!fit.has_enough_samples()) {
                ++tracks.windows_too_few_samples;
                continue;
            }
            fit.factorise();
            if (!(fit.least_pivot() > least_pivot)) {
                ++tracks.rows_not_separable;
                continue;
            }
            const WindowFit::Torque torque = fit.fit(part(signal.torque_nm));
            const std::size_t free = window.size() - fit.unknowns();
            const double square = dot(torque.residual.data(), torque.residual.data(), window.size());
            add_row(signal, window, tracks);
            add_amplitudes(fit, torque, square / static_cast<double>(free), tracks);
            squares += square;
            freedom += free;
        }
    }
    if (freedom > 0) tracks.residual_rms_nm = std::sqrt(squares / static_cast<double>(freedom));
    return tracks;
}

double speed_step(const SpeedSpan& speeds) {
    const double slowest_deg_s = speeds.from.value(), fastest_deg_s = speeds.to.value();
    const double fastest = std::max(std::abs(slowest_deg_s), std::abs(fastest_deg_s));
    const double least = std::max((fastest_deg_s - slowest_deg_s) / ranges_wanted, finest_share * fastest);
    if (!(least > 0.0)) return 1.0;
    const double power = portable::pow(10.0, std::floor(portable::log10(least)));
    for (const double step : {1.0, 2.0, 5.0}) {
        if (step * power >= least) return step * power;
    }
    return 10.0 * power;
}

SpeedTrack gather_by_speed(const OrderTracks& tracks, DegPerSec step) {
    SpeedTrack result;
    result.lines.resize(tracks.lines.size());
    if (tracks.speed_deg_s.empty()) return result;
    const auto [low, high] = std::minmax_element(tracks.speed_deg_s.begin(), tracks.speed_deg_s.end());
    result.step_deg_s = step.value() > 0.0 ? step.value() : speed_step({DegPerSec(*low), DegPerSec(*high)});
    std::map<long long, std::vector<std::size_t>> ranges;
    for (std::size_t row = 0; row < tracks.speed_deg_s.size(); ++row) {
        ranges[std::llround(tracks.speed_deg_s[row] / result.step_deg_s)].push_back(row);
    }
    for (const auto& [range, rows] : ranges) {
        double speed = 0.0;
        for (const std::size_t row : rows) speed += tracks.speed_deg_s[row];
        result.speed_deg_s.push_back(speed / static_cast<double>(rows.size()));
        result.rows.push_back(rows.size());
        for (std::size_t i = 0; i < tracks.lines.size(); ++i)
            gather_line(tracks.lines[i], rows, result.lines[i]);
    }
    return result;
}

std::vector<std::size_t> track_breaks(const OrderTracks& tracks) {
    const std::vector<double>& time_s = tracks.time_s;
    const std::vector<double>& speed = tracks.speed_deg_s;
    const auto step = [&](std::size_t row) { return time_s[row] - time_s[row - 1]; };
    std::vector<std::size_t> breaks;
    for (std::size_t row = 1; row < time_s.size(); ++row) {
        const bool turned = speed[row] * speed[row - 1] < 0.0;
        double neighbour = 0.0;
        if (row > 1) neighbour = std::max(neighbour, step(row - 1));
        if (row + 1 < time_s.size()) neighbour = std::max(neighbour, step(row + 1));
        if (turned || (neighbour > 0.0 && step(row) > longest_step * neighbour)) breaks.push_back(row);
    }
    return breaks;
}

std::vector<std::size_t> track_breaks(const SpeedTrack& tracks) {
    const std::vector<double>& speed = tracks.speed_deg_s;
    std::vector<std::size_t> breaks;
    for (std::size_t row = 1; row < speed.size(); ++row) {
        // The mean of a range lies anywhere in it, so that neighbours are less than two widths apart.
        if (speed[row] - speed[row - 1] > 2.0 * tracks.step_deg_s) breaks.push_back(row);
    }
    return breaks;
}

}  // namespace ripplenotch
