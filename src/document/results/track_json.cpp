// SPDX-License-Identifier: MIT
#include "ripplenotch/document/track_json.hpp"

#include "document/fields/document_head.hpp"
#include "document/fields/gear_fields.hpp"
#include "document/fields/ripple_fields.hpp"

namespace ripplenotch {
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

}  // namespace ripplenotch
