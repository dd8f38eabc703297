// SPDX-License-Identifier: MIT
#include "ripplenotch/artifact/metrics.hpp"

#include <cmath>

#include "artifact/json.hpp"

namespace ripplenotch {
namespace {

Json pair_to_json(const std::vector<double>& values) {
    return {{"raw", finite_or_null(values[0])}, {"filtered", finite_or_null(values[1])}};
}

Json order_to_json(const OrderLevel& level) {
    const auto attenuation = attenuation_db(level);
    Json json;
    json["order"] = level.order;
    json["hz"] = finite_or_null(level.mean_hz);
    json["raw_nm"] = finite_or_null(level.amplitude_nm[0]);
    json["filtered_nm"] = finite_or_null(level.amplitude_nm[1]);
    json["attenuation_db"] = attenuation ? Json(*attenuation) : Json(nullptr);
    return json;
}

// Null figures, not zeros, when there was nothing to measure them on.
void add_levels(Json& json, const FilterMetrics& metrics) {
    const bool measured = metrics.levels && metrics.levels->windows > 0;
    json["gear_ratio"] = metrics.gear_ratio ? Json(metrics.gear_ratio->value()) : Json(nullptr);
    json["orders"] = Json::array();
    if (!measured) {
        for (const char* name : {"residual_rms_nm", "residual_peak_to_peak_nm", "ripple_peak_to_peak_nm"}) {
            json[name] = nullptr;
        }
    } else {
        const RippleLevels& levels = *metrics.levels;
        for (const OrderLevel& level : levels.orders) json["orders"].push_back(order_to_json(level));
        json["residual_rms_nm"] = pair_to_json(levels.residual_rms_nm);
        json["residual_peak_to_peak_nm"] = pair_to_json(levels.residual_peak_to_peak_nm);
        json["ripple_peak_to_peak_nm"] = pair_to_json(levels.ripple_peak_to_peak_nm);
    }
    if (!metrics.levels) {
        json["windows"] = nullptr;
        return;
    }
    json["windows"] = {{"measured", metrics.levels->windows},
                       {"measured_share", metrics.levels->measured_share},
                       {"too_slow", metrics.levels->windows_too_slow},
                       {"too_few_samples", metrics.levels->windows_too_few_samples}};
}

Json delay_to_json(const FilterDelay& delay) {
    Json json;
    if (delay.band > 0) json["band"] = delay.band;
    if (delay.to.value() > 0.0) {
        json["speed_from_deg_s"] = delay.from.value();
        json["speed_to_deg_s"] = delay.to.value();
    }
    json["filter"] = delay.filter;
    json["dc_delay_ms"] = 1e3 * delay.dc_delay.value();
    return json;
}

Json switch_to_json(const TimedSwitch& entry) {
    Json json;
    json["time_s"] = finite_or_null(entry.time_s);
    json["sample"] = entry.change.sample;
    json["from_band"] = entry.change.from_band;
    json["to_band"] = entry.change.to_band;
    json["speed_deg_s"] = finite_or_null(entry.change.speed_deg_s);
    json["jump_nm"] = finite_or_null(entry.change.jump_nm);
    return json;
}

void add_stream(Json& json, const FilterMetrics& metrics) {
    const StreamReport& stream = metrics.stream;
    json["rows"] = stream.rows;
    json["sample_rate_hz"] = metrics.sample_rate.value();
    json["measured_sample_rate_hz"] = finite_or_null(stream.measured_rate.value());
    if (metrics.table_rate) json["table_sample_rate_hz"] = metrics.table_rate->value();
    json["gap_count"] = stream.gap_count;
    json["gaps"] = Json::array();
    for (const Gap& gap : stream.gaps) {
        json["gaps"].push_back({{"row", gap.row}, {"from_s", gap.from_s}, {"to_s", gap.to_s}});
    }
    json["repeated_times"] = stream.repeated_times;
    json["held_samples"] = stream.held_samples;
    json["held_bad_values"] = stream.held_bad_values;
}

}  // namespace

std::optional<double> attenuation_db(const OrderLevel& level) {
    const double raw = level.amplitude_nm[0], filtered = level.amplitude_nm[1];
    if (!(raw > 0.0) || !(filtered > 0.0)) return std::nullopt;
    return 20.0 * std::log10(raw / filtered);
}

std::string metrics_to_json(const FilterMetrics& metrics, const Provenance& provenance) {
    Json json = document_head("metrics", provenance);
    json["source"] = metrics.source;
    json["joint"] = metrics.joint.empty() ? Json(nullptr) : Json(metrics.joint);
    json["method"] = metrics.method;
    add_stream(json, metrics);
    add_levels(json, metrics);
    json["delays"] = Json::array();
    for (const FilterDelay& delay : metrics.delays) json["delays"].push_back(delay_to_json(delay));
    json["switch_count"] = metrics.stream.switch_count;
    json["switches"] = Json::array();
    for (const TimedSwitch& entry : metrics.stream.switches)
        json["switches"].push_back(switch_to_json(entry));
    return to_text(json);
}

}  // namespace ripplenotch
