// SPDX-License-Identifier: MIT
#include "ripplenotch/analysis/track_by_speed.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <map>

#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

constexpr double ranges_wanted = 24.0;  // by hand: rows that a person reads
constexpr double finest_share =
    0.01;  ///< of the highest speed: a steady log is not cut up by its speed noise

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

}  // namespace

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

}  // namespace ripplenotch
