// SPDX-License-Identifier: MIT
#include "ripplenotch/document/metrics_json.hpp"

#include <utility>

#include "document/fields/document_head.hpp"
#include "document/fields/gear_fields.hpp"
#include "document/fields/ledger_fields.hpp"
#include "document/fields/recording_fields.hpp"

namespace ripplenotch {
namespace {

Json pair_to_json(const std::vector<double>& values) {
    return {{"raw", finite_or_null(values[0])}, {"filtered", finite_or_null(values[1])}};
}

Json order_to_json(const FilterMetrics& metrics, std::size_t order) {
    const OrderLevel& level = metrics.levels->orders[order];
    const auto predicted = predicted_nm(metrics, order);
    const auto attenuation = attenuation_db(level);
    Json json = Json::object();
    json["order"] = level.order;
    json["hz"] = finite_or_null(level.mean_hz);
    json["raw_nm"] = finite_or_null(level.amplitude_nm[0]);
    json["filtered_nm"] = finite_or_null(level.amplitude_nm[1]);
    json["attenuation_db"] = attenuation ? Json(*attenuation) : Json(nullptr);
    json["predicted_nm"] = predicted ? finite_or_null(*predicted) : Json(nullptr);
    if (predicted) json["predicted_from"] = metrics.gear->amplitude_nm.empty() ? "log" : "joint";
    return json;
}

// Null figures, not zeros, when there was nothing to measure them on.
void add_levels(Json& json, const FilterMetrics& metrics) {
    const bool measured = metrics.levels && metrics.levels->windows > 0;
    json["gear_ratio"] = metrics.gear ? Json(metrics.gear->ratio.value()) : Json(nullptr);
    json["gear"] = gear_to_json(metrics.gear);
    json["orders"] = Json::array();
    if (!measured) {
        for (const char* name : {"residual_rms_nm", "residual_peak_to_peak_nm", "ripple_peak_to_peak_nm"}) {
            json[name] = nullptr;
        }
    } else {
        const RippleLevels& levels = *metrics.levels;
        for (std::size_t i = 0; i < levels.orders.size(); ++i)
            list_in(json, "orders").push_back(order_to_json(metrics, i));
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
                       {"too_few_samples", metrics.levels->windows_too_few_samples}};
}

void add_stream(Json& json, const FilterMetrics& metrics) {
    const StreamReport& stream = metrics.stream;
    const ClockFacts& clock = stream.recording.clock;
    json["rows"] = clock.rows;
    json["sample_rate_hz"] = metrics.sample_rate.value();
    json["measured_sample_rate_hz"] = finite_or_null(clock.mean_rate.value());
    if (metrics.table_rate) json["table_sample_rate_hz"] = metrics.table_rate->value();
    json["gap_count"] = clock.gap_count;
    json["gaps"] = gaps_json(clock);
    json["repeated_times"] = clock.repeated_times;
    json["speed_deg_s"] = {finite_or_null(stream.slowest_deg_s), finite_or_null(stream.fastest_deg_s)};
    json["held_samples"] = stream.recording.held.count;
    json["held_bad_values"] = stream.held_bad_values;
}

}  // namespace

std::string metrics_to_json(const FilterMetrics& metrics, const Provenance& provenance) {
    Json json = document_head("metrics", provenance);
    json["source"] = metrics.source;
    json["joint"] = metrics.joint.empty() ? Json(nullptr) : Json(metrics.joint);
    json["method"] = metrics.method;
    add_stream(json, metrics);
    add_levels(json, metrics);
    json["crossover_hz"] = metrics.crossover ? Json(metrics.crossover->value()) : Json(nullptr);
    json["delays"] = Json::array();
    for (const LedgerEntry& entry : metrics.delays)
        list_in(json, "delays").push_back(ledger_entry_to_json(entry));
    json["switch_count"] = metrics.stream.switch_count;
    json["switches"] = Json::array();
    for (const TimedSwitch& entry : metrics.stream.switches)
        list_in(json, "switches").push_back(switch_to_json(entry.change, Seconds(entry.time_s)));
    return to_fitted_text(std::move(json));
}

}  // namespace ripplenotch
