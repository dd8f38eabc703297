// SPDX-License-Identifier: MIT
#include "ripplenotch/analysis/track_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "ripplenotch/core/number.hpp"

namespace ripplenotch {
namespace {

struct WrittenKind {
    double factor;
    std::string_view name, words;
};

const WrittenKind& written(AmplitudeKind kind) {
    static constexpr std::array kinds = {WrittenKind{1.0, "amplitude_nm", "zero to peak"},
                                         WrittenKind{1.0 / std::numbers::sqrt2, "rms_nm", "rms"},
                                         WrittenKind{2.0, "peak_to_peak_nm", "peak to peak"}};
    return kinds[static_cast<std::size_t>(kind)];
}

// Six significant digits, and no negative zero: more would be rounding noise of the fit.
std::vector<double> rounded_to_factor(std::vector<double> values, double factor) {
    for (double& value : values) {
        if (std::isfinite(value)) value = *parse_number(fmt::format("{:.6g}", factor * value)) + 0.0;
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

// Where an envelope has as much log before as after it. Within one response time of an end it rests on one
// side alone, and may be anything.
struct Settled {
    bool any = false;  ///< false: all rows count
    double from_s = 0.0, to_s = 0.0;
    [[nodiscard]] bool holds(double time_s) const { return time_s >= from_s && time_s <= to_s; }
};

Settled settled_of(const TrackReport& report, const std::vector<double>& amplitude) {
    const std::vector<double>& time_s = report.tracks.time_s;
    const auto bandwidth = report.bandwidth_obtained ? report.bandwidth_obtained : report.bandwidth;
    if (report.by_speed || !bandwidth || !(bandwidth->value() > 0.0) || time_s.empty()) return {};
    const double response_s = 1.0 / bandwidth->value();
    Settled settled{false, time_s.front() + response_s, time_s.back() - response_s};
    for (std::size_t row = 0; row < time_s.size() && !settled.any; ++row)
        settled.any = std::isfinite(amplitude[row]) && settled.holds(time_s[row]);
    return settled;
}

const std::vector<double>& speeds_of(const TrackReport& report) {
    return report.by_speed ? report.by_speed->speed_deg_s : report.tracks.speed_deg_s;
}

}  // namespace

double amplitude_factor(AmplitudeKind kind) { return written(kind).factor; }
std::string_view amplitude_name(AmplitudeKind kind) { return written(kind).name; }
std::string_view amplitude_words(AmplitudeKind kind) { return written(kind).words; }

std::string TrackLabel::column() const {
    if (kind == Kind::tone) return fmt::format("tone_{}hz", shortest(value));
    return (kind == Kind::order ? "order_" : "order_output_") + shortest(value);
}

std::string TrackLabel::words() const {
    if (kind == Kind::tone) return fmt::format("{} Hz", shortest(value));
    return (kind == Kind::order ? "order " : "output order ") + shortest(value);
}

std::vector<TrackColumn> track_columns(const TrackReport& report) {
    const double factor = amplitude_factor(report.kind);
    std::vector<TrackColumn> columns;
    if (report.by_speed) {
        columns.push_back({"speed_deg_s", rounded_to_factor(report.by_speed->speed_deg_s, 1.0)});
        columns.push_back({"rows", as_numbers(report.by_speed->rows)});
    } else {
        columns.push_back({"time_s", report.tracks.time_s});
        // Time may be large: microseconds, not digits.
        for (double& time : columns.back().values) time = std::round(time * 1e6) / 1e6 + 0.0;
        columns.push_back({"speed_deg_s", rounded_to_factor(report.tracks.speed_deg_s, 1.0)});
    }
    for (std::size_t i = 0; i < report.labels.size(); ++i) {
        const std::string prefix = report.labels[i].column() + "_";
        const auto add = [&](std::string_view name, const std::vector<double>& values, double scale) {
            columns.push_back({prefix + std::string(name), rounded_to_factor(values, scale)});
        };
        add(amplitude_name(report.kind), amplitudes(report, i), factor);
        if (report.by_speed) {
            add("phase_deg", report.by_speed->lines[i].phase_deg, 1.0);
            add("spread_nm", report.by_speed->lines[i].spread_nm, factor);
        } else {
            add("phase_deg", report.tracks.lines[i].phase_deg, 1.0);
            add("standard_error_nm", report.tracks.lines[i].standard_error_nm, factor);
        }
    }
    return columns;
}

TrackSummary track_summary(const TrackReport& report, std::size_t line) {
    const std::vector<double>& amplitude = amplitudes(report, line);
    const Settled settled = settled_of(report, amplitude);
    std::vector<std::pair<double, std::size_t>> sorted;
    std::size_t rows = 0;
    for (std::size_t row = 0; row < amplitude.size(); ++row) {
        if (!std::isfinite(amplitude[row])) continue;
        ++rows;
        if (!settled.any || settled.holds(report.tracks.time_s[row]))
            sorted.emplace_back(amplitude[row], row);
    }
    if (sorted.empty()) return {};
    std::sort(sorted.begin(), sorted.end());
    const std::size_t n = sorted.size();
    const double median = 0.5 * (sorted[(n - 1) / 2].first + sorted[n / 2].first);
    const double factor = amplitude_factor(report.kind);
    return {rows,
            factor * median,
            factor * sorted.front().first,
            factor * sorted.back().first,
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
        const double factor = amplitude_factor(report.kind);
        if (ripple && ripple->searched() && !ripple->present())
            text += fmt::format(": not above the noise, where {:.2g} Nm {} would be seen",
                                factor * ripple->detectable_nm, amplitude_words(report.kind));
        else if (ripple && ripple->searched())
            text += fmt::format(": {:.3g} +/- {:.1g} Nm {}", factor * ripple->amplitude_nm,
                                factor * ripple->standard_error_nm, amplitude_words(report.kind));
        else
            text += fmt::format(": {:.3g} Nm {}", line.median_nm, amplitude_words(report.kind));
        text += line.rows == 1
                    ? fmt::format(" at {:.4g} deg/s", line.least_at_deg_s)
                    : fmt::format(", from {:.3g} at {:.4g} to {:.3g} at {:.4g} deg/s", line.least_nm,
                                  line.least_at_deg_s, line.greatest_nm, line.greatest_at_deg_s);
    }
    return text + fmt::format("; {:.2g} Nm rms are neither line nor trend.", report.tracks.residual_rms_nm);
}

}  // namespace ripplenotch
