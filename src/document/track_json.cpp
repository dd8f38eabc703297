// SPDX-License-Identifier: MIT
#include "ripplenotch/document/track_json.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "document/gear_fields.hpp"
#include "ripplenotch/core/number.hpp"

namespace ripplenotch {
namespace {

/// Six significant digits, and no negative zero: more would be rounding noise of the fit.
std::vector<double> rounded(std::vector<double> values, double factor) {
    for (double& value : values) {
        if (std::isfinite(value)) value = *parse_number(fmt::format("{:.6g}", factor * value)) + 0.0;
    }
    return values;
}

std::vector<double> as_numbers(const std::vector<std::size_t>& counts) {
    return {counts.begin(), counts.end()};
}

Json array_of(const std::vector<double>& values) {
    Json json = Json::array();
    for (const double value : values) json.push_back(finite_or_null(value));
    return json;
}

template <class Tag>
Json or_null(const std::optional<Quantity<Tag>>& value) {
    return value ? Json(value->value()) : Json(nullptr);
}

/// Rows of a line that were measured, by amplitude.
struct Range {
    std::size_t count = 0, least = 0, greatest = 0;
    double median_nm = 0.0;
};

Range range_of(const std::vector<double>& amplitude) {
    std::vector<std::pair<double, std::size_t>> sorted;
    for (std::size_t row = 0; row < amplitude.size(); ++row) {
        if (std::isfinite(amplitude[row])) sorted.emplace_back(amplitude[row], row);
    }
    if (sorted.empty()) return {};
    std::sort(sorted.begin(), sorted.end());
    const std::size_t n = sorted.size();
    const double median = 0.5 * (sorted[(n - 1) / 2].first + sorted[n / 2].first);
    return {n, sorted.front().second, sorted.back().second, median};
}

const std::vector<double>& amplitudes(const TrackReport& report, std::size_t line) {
    return report.by_speed ? report.by_speed->lines[line].amplitude_nm
                           : report.tracks.lines[line].amplitude_nm;
}

const std::vector<double>& speeds(const TrackReport& report) {
    return report.by_speed ? report.by_speed->speed_deg_s : report.tracks.speed_deg_s;
}

std::string_view kind_words(AmplitudeKind kind) {
    switch (kind) {
        case AmplitudeKind::peak:
            return "zero to peak";
        case AmplitudeKind::rms:
            return "rms";
        case AmplitudeKind::peak_to_peak:
            return "peak to peak";
    }
    return "";
}

Json line_to_json(const TrackReport& report, std::size_t i) {
    const TrackLabel& label = report.labels[i];
    const Range range = range_of(amplitudes(report, i));
    const double factor = amplitude_factor(report.kind);
    const auto value = [&](std::size_t row) { return finite_or_null(factor * amplitudes(report, i)[row]); };
    Json json;
    json["name"] = label.column();
    json["order"] = label.kind == TrackLabel::Kind::order ? Json(label.value) : Json(nullptr);
    json["order_output"] = label.kind == TrackLabel::Kind::order_output ? Json(label.value) : Json(nullptr);
    json["hz"] = label.kind == TrackLabel::Kind::tone ? Json(label.value) : Json(nullptr);
    json["rows_measured"] = range.count;
    json["median_nm"] = range.count > 0 ? Json(factor * range.median_nm) : Json(nullptr);
    json["least_nm"] = range.count > 0 ? value(range.least) : Json(nullptr);
    json["greatest_nm"] = range.count > 0 ? value(range.greatest) : Json(nullptr);
    return json;
}

}  // namespace

double amplitude_factor(AmplitudeKind kind) {
    switch (kind) {
        case AmplitudeKind::peak:
            return 1.0;
        case AmplitudeKind::rms:
            return 1.0 / std::numbers::sqrt2;
        case AmplitudeKind::peak_to_peak:
            return 2.0;
    }
    return 1.0;
}

std::string_view amplitude_name(AmplitudeKind kind) {
    switch (kind) {
        case AmplitudeKind::peak:
            return "amplitude_nm";
        case AmplitudeKind::rms:
            return "rms_nm";
        case AmplitudeKind::peak_to_peak:
            return "peak_to_peak_nm";
    }
    return "";
}

std::string TrackLabel::column() const {
    switch (kind) {
        case Kind::order:
            return fmt::format("order_{}", shortest(value));
        case Kind::order_output:
            return fmt::format("order_output_{}", shortest(value));
        case Kind::tone:
            return fmt::format("tone_{}hz", shortest(value));
    }
    return "";
}

std::string TrackLabel::words() const {
    switch (kind) {
        case Kind::order:
            return fmt::format("order {}", shortest(value));
        case Kind::order_output:
            return fmt::format("output order {}", shortest(value));
        case Kind::tone:
            return fmt::format("{} Hz", shortest(value));
    }
    return "";
}

std::vector<TrackColumn> track_columns(const TrackReport& report) {
    const double factor = amplitude_factor(report.kind);
    std::vector<TrackColumn> columns;
    if (report.by_speed) {
        columns.push_back({"speed_deg_s", rounded(report.by_speed->speed_deg_s, 1.0)});
        columns.push_back({"rows", as_numbers(report.by_speed->rows)});
    } else {
        columns.push_back({"time_s", report.tracks.time_s});
        // Time may be large: microseconds, not digits.
        for (double& time : columns.back().values) time = std::round(time * 1e6) / 1e6 + 0.0;
        columns.push_back({"speed_deg_s", rounded(report.tracks.speed_deg_s, 1.0)});
    }
    for (std::size_t i = 0; i < report.labels.size(); ++i) {
        const std::string prefix = report.labels[i].column() + "_";
        columns.push_back(
            {prefix + std::string(amplitude_name(report.kind)), rounded(amplitudes(report, i), factor)});
        if (report.by_speed) {
            columns.push_back({prefix + "phase_deg", rounded(report.by_speed->lines[i].phase_deg, 1.0)});
            columns.push_back({prefix + "spread_nm", rounded(report.by_speed->lines[i].spread_nm, factor)});
        } else {
            columns.push_back({prefix + "phase_deg", rounded(report.tracks.lines[i].phase_deg, 1.0)});
            columns.push_back(
                {prefix + "standard_error_nm", rounded(report.tracks.lines[i].standard_error_nm, factor)});
        }
    }
    return columns;
}

std::string track_verdict(const TrackReport& report) {
    const double factor = amplitude_factor(report.kind);
    std::string text;
    for (std::size_t i = 0; i < report.labels.size(); ++i) {
        const auto& amplitude = amplitudes(report, i);
        const Range range = range_of(amplitude);
        if (!text.empty()) text += "; ";
        if (range.count == 0) {
            text += fmt::format("{}: measured nowhere", report.labels[i].words());
            continue;
        }
        if (range.count == 1) {
            text +=
                fmt::format("{}: {:.3g} Nm {} at {:.4g} deg/s", report.labels[i].words(),
                            factor * range.median_nm, kind_words(report.kind), speeds(report)[range.least]);
            continue;
        }
        text += fmt::format("{}: {:.3g} Nm {}, from {:.3g} at {:.4g} to {:.3g} at {:.4g} deg/s",
                            report.labels[i].words(), factor * range.median_nm, kind_words(report.kind),
                            factor * amplitude[range.least], speeds(report)[range.least],
                            factor * amplitude[range.greatest], speeds(report)[range.greatest]);
    }
    return text + fmt::format("; {:.2g} Nm rms are neither line nor trend.", report.tracks.residual_rms_nm);
}

std::string track_text(const TrackReport& report, const Provenance& provenance) {
    Json json = document_head("track", provenance);
    json["verdict"] = track_verdict(report);
    json["joint"] = report.joint;
    json["method"] = report.method;
    json["against"] = report.by_speed ? "speed" : "time";
    json["amplitude"] = kind_words(report.kind);
    json["gear_ratio"] = report.gear ? Json(report.gear->ratio.value()) : Json(nullptr);
    json["gear"] = gear_to_json(report.gear);
    json["angle"] = report.angle_from_position ? "position" : "integrated velocity";
    json["window_turns"] = report.window_turns ? Json(*report.window_turns) : Json(nullptr);
    json["window_s"] = or_null(report.window);
    json["bandwidth_hz"] = or_null(report.bandwidth);
    json["bandwidth_obtained_hz"] = or_null(report.bandwidth_obtained);
    json["poles"] = report.poles ? Json(*report.poles) : Json(nullptr);
    json["speed_step_deg_s"] = report.by_speed ? Json(report.by_speed->step_deg_s) : Json(nullptr);
    json["residual_rms_nm"] = report.tracks.residual_rms_nm;
    json["rows_folded"] = report.tracks.rows_folded;
    json["rows_not_separable"] = report.tracks.rows_not_separable;
    json["windows_too_slow"] = report.tracks.windows_too_slow;
    json["windows_too_few_samples"] = report.tracks.windows_too_few_samples;
    json["lines"] = Json::array();
    for (std::size_t i = 0; i < report.labels.size(); ++i) json["lines"].push_back(line_to_json(report, i));
    json["columns"] = Json::object();
    for (const TrackColumn& column : track_columns(report))
        json["columns"][column.name] = array_of(column.values);
    return to_fitted_text(std::move(json));
}

}  // namespace ripplenotch
