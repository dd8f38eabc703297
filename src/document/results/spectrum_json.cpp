// SPDX-License-Identifier: MIT
#include <algorithm>
#include <utility>

#include "document/fields/fields.hpp"
#include "document/fields/result_fields.hpp"
#include "document/json/json.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/document/spectrum_json.hpp"

namespace ripplenotch {

std::string speed_map_text(const std::string& joint, const SpeedMap& map, std::string_view axis_name,
                           const std::optional<GearAccount>& gear, const Provenance& provenance) {
    Json json = document_head("spectrum", provenance);
    json["joint"] = joint;
    json["domain"] = map.axis_kind == Axis::time ? "campbell" : "order-map";
    json["gear"] = gear_to_json(gear);
    json["window"] = "hann";
    json["resolution"] = six_digits(map.resolution);
    json["speed_step_deg_s"] = map.speed_step_deg_s;
    json["runs_too_short"] = map.runs_too_short;
    json["axis"] = axis_name;
    json["axis_values"] = Json::array();
    for (const double value : map.axis) list_in(json, "axis_values").push_back(six_digits(value));
    json["rows"] = Json::array();
    for (std::size_t row = 0; row < map.speed_deg_s.size(); ++row) {
        Json one = Json::object();
        one["speed_deg_s"] = six_digits(map.speed_deg_s[row]);
        one["windows"] = map.windows[row];
        one["amplitude_nm"] = Json::array();
        for (const double value : map.amplitude_nm[row])
            list_in(one, "amplitude_nm").push_back(six_digits(value));
        list_in(json, "rows").push_back(std::move(one));
    }
    return to_fitted_text(std::move(json));
}

namespace {

Json array_of(const std::vector<double>& values) {
    Json json = Json::array();
    for (const double value : values) json.push_back(finite_or_null(value));
    return json;
}

template <class Tag>
Json quantity_or_null(const std::optional<Quantity<Tag>>& value) {
    return value ? Json(value->value()) : Json(nullptr);
}

Json tracked_line_to_json(const TrackReport& report, std::size_t i) {
    const TrackLabel& label = report.labels[i];
    const TrackSummary line = track_summary(report, i);
    const auto of_kind = [&](TrackLabel::Kind kind) {
        return label.kind == kind ? Json(label.value) : Json(nullptr);
    };
    const auto measured = [&](double value) { return line.rows > 0 ? finite_or_null(value) : Json(nullptr); };
    Json json = Json::object();
    json["name"] = label.column();
    json["order"] = of_kind(TrackLabel::Kind::order);
    json["order_output"] = of_kind(TrackLabel::Kind::order_output);
    json["hz"] = of_kind(TrackLabel::Kind::tone);
    json["ripple"] = report.ripple[i] ? ripple_to_json(*report.ripple[i]) : Json(nullptr);
    json["rows_measured"] = line.rows;
    json["median_nm"] = measured(line.median_nm);
    json["least_nm"] = measured(line.least_nm);
    json["greatest_nm"] = measured(line.greatest_nm);
    return json;
}

}  // namespace

std::string track_text(const TrackReport& report, const Provenance& provenance) {
    Json json = document_head("track", provenance);
    json["verdict"] = report.doubt + track_verdict(report);
    json["joint"] = report.joint;
    json["method"] = report.method;
    json["against"] = report.by_speed ? "speed" : "time";
    json["amplitude"] = amplitude_words(report.kind);
    json["gear_ratio"] = report.gear ? Json(report.gear->ratio.value()) : Json(nullptr);
    json["gear"] = gear_to_json(report.gear);
    json["angle"] = report.angle_from_position ? "position" : "integrated velocity";
    json["window_turns"] = report.window_turns ? Json(*report.window_turns) : Json(nullptr);
    json["window_s"] = quantity_or_null(report.window);
    json["bandwidth_hz"] = quantity_or_null(report.bandwidth);
    json["bandwidth_obtained_hz"] = quantity_or_null(report.bandwidth_obtained);
    json["poles"] = report.poles ? Json(*report.poles) : Json(nullptr);
    json["speed_step_deg_s"] = report.by_speed ? Json(report.by_speed->step_deg_s) : Json(nullptr);
    json["residual_rms_nm"] = report.tracks.residual_rms_nm;
    json["rows_folded"] = report.tracks.rows_folded;
    json["rows_not_separable"] = report.tracks.rows_not_separable;
    json["windows_too_few_samples"] = report.tracks.windows_too_few_samples;
    json["lines"] = Json::array();
    for (std::size_t i = 0; i < report.labels.size(); ++i)
        list_in(json, "lines").push_back(tracked_line_to_json(report, i));
    json["columns"] = Json::object();
    for (const TrackColumn& column : track_columns(report))
        json["columns"][column.name] = array_of(column.values);
    return to_fitted_text(std::move(json));
}

namespace {

Json peak_to_json(const SpectralPeak& peak) {
    return {{"hz", peak.hz},
            {"hz_stderr", peak.hz_stderr},
            {"amplitude_nm", peak.amplitude_nm},
            {"phase_deg", peak.phase_deg},
            {"floor_nm", peak.floor_nm},
            {"snr", peak.snr},
            {"false_alarm", peak.false_alarm}};
}

Json hump_to_json(const SpectralHump& hump) {
    return {{"from_hz", hump.from_hz},        {"to_hz", hump.to_hz},   {"peak_hz", hump.peak_hz},
            {"peak_nm", hump.peak_nm},        {"rms_nm", hump.rms_nm}, {"floor_nm", hump.floor_nm},
            {"false_alarm", hump.false_alarm}};
}

Json motion_line_to_json(const MotionLine& line) {
    Json json = Json::object();
    json["kind"] = line_kind_name(line.kind);
    const bool tone = line.kind == LineKind::tone;
    json["order_output"] = tone ? Json(nullptr) : Json(line.order_output);
    json["order_output_stderr"] = tone ? Json(nullptr) : Json(line.order_stderr);
    json["hz"] = line.kind == LineKind::order ? Json(nullptr) : Json(line.hz);
    json["amplitude_nm"] = line.amplitude_nm;
    json["phase_deg"] = line.phase_deg ? Json(*line.phase_deg) : Json(nullptr);
    json["floor_nm"] = line.floor_nm;
    json["snr"] = line.snr;
    json["false_alarm"] = line.false_alarm;
    return json;
}

Json head(std::string_view domain, const std::string& joint, double false_alarm,
          const Provenance& provenance) {
    Json json = document_head("spectrum", provenance);
    json["joint"] = joint;
    json["domain"] = domain;
    json["window"] = "hann";
    json["false_alarm"] = false_alarm;
    return json;
}

}  // namespace

double median_floor(const std::vector<double>& floor_nm) {
    std::vector<double> known;
    std::copy_if(floor_nm.begin(), floor_nm.end(), std::back_inserter(known),
                 [](double value) { return value > 0.0; });
    if (known.empty()) return 0.0;
    return median_in(known);
}

std::string spectra_text(const std::string& joint, const std::vector<StretchSpectrum>& spectra,
                         double false_alarm, const Provenance& provenance) {
    Json json = head("frequency", joint, false_alarm, provenance);
    json["spectra"] = Json::array();
    for (const StretchSpectrum& one : spectra) {
        Json entry = Json::object();
        entry["stretch"] = one.number ? Json(*one.number) : Json(nullptr);
        entry["first_row"] = one.stretch.first;
        entry["rows"] = one.stretch.count;
        entry["duration_s"] = one.stretch.duration.value();
        entry["speed_deg_s"] = one.stretch.speed.value();
        entry["turning_deg_s"] = one.stretch.turning_deg_s;
        entry["turning_spread_deg_s"] = one.stretch.turning_spread_deg_s;
        entry["pieces"] = one.spectrum.pieces;
        entry["piece_duration_s"] = one.spectrum.piece_duration.value();
        entry["bin_width_hz"] = one.spectrum.bin_width.value();
        entry["resolution_hz"] = one.spectrum.resolution.value();
        entry["noise_floor_nm"] = median_floor(one.spectrum.floor_nm);
        entry["peaks"] = Json::array();
        for (const SpectralPeak& peak : one.spectrum.peaks)
            list_in(entry, "peaks").push_back(peak_to_json(peak));
        entry["humps"] = Json::array();
        for (const SpectralHump& hump : one.spectrum.humps)
            list_in(entry, "humps").push_back(hump_to_json(hump));
        list_in(json, "spectra").push_back(std::move(entry));
    }
    return to_fitted_text(std::move(json));
}

std::string order_spectrum_text(const std::string& joint, const OrderSpectrum& spectrum, double false_alarm,
                                const Provenance& provenance) {
    Json json = head("order", joint, false_alarm, provenance);
    json["doubt"] = spectrum.doubt;
    json["sweeps"] = spectrum.lines.sweeps;
    json["output_turns"] = spectrum.lines.turns;
    json["speed_range_deg_s"] = {spectrum.lines.slowest_deg_s, spectrum.lines.fastest_deg_s};
    json["bin_width_orders"] = spectrum.stack.spacing;
    json["resolution_orders"] = spectrum.stack.resolution;
    json["noise_floor_nm"] = median_floor(spectrum.stack.floor_nm);
    json["lines"] = Json::array();
    for (const MotionLine& line : spectrum.lines.lines)
        list_in(json, "lines").push_back(motion_line_to_json(line));
    return to_fitted_text(std::move(json));
}

}  // namespace ripplenotch
