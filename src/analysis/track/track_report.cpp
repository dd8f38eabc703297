// SPDX-License-Identifier: MIT
#include "ripplenotch/analysis/track_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "ripplenotch/core/number.hpp"

namespace ripplenotch {

namespace {

// Six significant digits, and no negative zero: more would be rounding noise of the fit.
std::vector<double> rounded(std::vector<double> values) {
    for (double& value : values) {
        if (std::isfinite(value)) value = *parse_number(fmt::format("{:.6g}", value)) + 0.0;
    }
    return values;
}

std::vector<double> as_numbers(const std::vector<std::size_t>& counts) {
    return {counts.begin(), counts.end()};
}

const std::vector<double>& amplitudes(const TrackReport& report, std::size_t line) {
    return report.by_speed ? report.by_speed->lines[line].amplitude_nm
                           : report.tracks.lines[line].amplitude_nm;
}

const std::vector<double>& speeds_of(const TrackReport& report) {
    return report.by_speed ? report.by_speed->speed_deg_s : report.tracks.speed_deg_s;
}

}  // namespace

std::string TrackLabel::column() const {
    if (kind == Kind::tone) return fmt::format("tone_{}hz", shortest(value));
    return (kind == Kind::order ? "order_" : "order_output_") + shortest(value);
}

std::string TrackLabel::words() const {
    if (kind == Kind::tone) return fmt::format("{} Hz", shortest(value));
    return (kind == Kind::order ? "order " : "output order ") + shortest(value);
}

std::vector<TrackColumn> track_columns(const TrackReport& report) {
    std::vector<TrackColumn> columns;
    if (report.by_speed) {
        columns.push_back({"speed_deg_s", rounded(report.by_speed->speed_deg_s)});
        columns.push_back({"rows", as_numbers(report.by_speed->rows)});
    } else {
        columns.push_back({"time_s", report.tracks.time_s});
        // Time may be large: microseconds, not digits.
        for (double& time : columns.back().values) time = std::round(time * 1e6) / 1e6 + 0.0;
        columns.push_back({"speed_deg_s", rounded(report.tracks.speed_deg_s)});
    }
    for (std::size_t i = 0; i < report.labels.size(); ++i) {
        const std::string prefix = report.labels[i].column() + "_";
        const auto add = [&](std::string_view name, const std::vector<double>& values) {
            columns.push_back({prefix + std::string(name), rounded(values)});
        };
        add("amplitude_nm", amplitudes(report, i));
        if (report.by_speed) {
            add("phase_deg", report.by_speed->lines[i].phase_deg);
            add("spread_nm", report.by_speed->lines[i].spread_nm);
        } else {
            add("phase_deg", report.tracks.lines[i].phase_deg);
            add("standard_error_nm", report.tracks.lines[i].standard_error_nm);
        }
    }
    return columns;
}

TrackSummary track_summary(const TrackReport& report, std::size_t line) {
    const std::vector<double>& amplitude = amplitudes(report, line);
    std::vector<std::pair<double, std::size_t>> sorted;
    for (std::size_t row = 0; row < amplitude.size(); ++row)
        if (std::isfinite(amplitude[row])) sorted.emplace_back(amplitude[row], row);
    if (sorted.empty()) return {};
    std::sort(sorted.begin(), sorted.end());
    const std::size_t n = sorted.size();
    const double median = 0.5 * (sorted[(n - 1) / 2].first + sorted[n / 2].first);
    return {n,
            median,
            sorted.front().first,
            sorted.back().first,
            speeds_of(report)[sorted.front().second],
            speeds_of(report)[sorted.back().second]};
}

std::string track_verdict(const TrackReport& report) {
    std::string text;
    for (std::size_t i = 0; i < report.labels.size(); ++i) {
        const TrackSummary line = track_summary(report, i);
        if (!text.empty()) text += "; ";
        text += report.labels[i].words();
        if (line.rows == 0) {
            text += ": measured nowhere";
            continue;
        }
        const auto& ripple = report.ripple[i];
        if (ripple && ripple->searched() && !ripple->present())
            text += fmt::format(": not above the noise, where {:.2g} Nm zero to peak would be seen",
                                ripple->detectable_nm);
        else if (ripple && ripple->searched())
            text += fmt::format(": {:.3g} +/- {:.1g} Nm zero to peak", ripple->amplitude_nm,
                                ripple->standard_error_nm);
        else
            text += fmt::format(": {:.3g} Nm zero to peak", line.median_nm);
        text += line.rows == 1
                    ? fmt::format(" at {:.4g} deg/s", line.least_at_deg_s)
                    : fmt::format(", from {:.3g} at {:.4g} to {:.3g} at {:.4g} deg/s", line.least_nm,
                                  line.least_at_deg_s, line.greatest_nm, line.greatest_at_deg_s);
    }
    return text + fmt::format("; {:.2g} Nm rms are neither line nor trend.", report.tracks.residual_rms_nm);
}

}  // namespace ripplenotch
