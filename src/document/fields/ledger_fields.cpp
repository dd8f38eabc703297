// SPDX-License-Identifier: MIT
#include "document/fields/ledger_fields.hpp"

#include "ripplenotch/core/number.hpp"

namespace ripplenotch {
namespace {

Json milliseconds_or_null(const std::optional<Seconds>& time) {
    return time ? Json(1e3 * time->value()) : Json(nullptr);
}

}  // namespace

Json switch_to_json(const Switch& change, Seconds time) {
    Json json = Json::object();
    json["time_s"] = finite_or_null(time.value());
    json["sample"] = change.sample;
    json["from_band"] = change.from_band;
    json["to_band"] = change.to_band;
    json["speed_deg_s"] = finite_or_null(change.speed_deg_s);
    json["jump_nm"] = finite_or_null(change.jump_nm);
    return json;
}

Json switch_entry_to_json(const SwitchEntry& entry) {
    Json json = switch_to_json(entry.change, entry.time);
    json["stretch_ms"] = 1e3 * entry.stretch.value();
    json["error_before_nm"] = entry.error_before_nm ? Json(*entry.error_before_nm) : Json(nullptr);
    json["peak_error_nm"] = entry.peak_error_nm ? Json(*entry.peak_error_nm) : Json(nullptr);
    json["peak_after_ms"] = milliseconds_or_null(entry.peak_after);
    json["settle_ms"] = Json::object();
    for (std::size_t i = 0; i < settle_bands_percent.size(); ++i)
        json["settle_ms"][shortest(settle_bands_percent[i])] = milliseconds_or_null(entry.settle[i]);
    return json;
}

Json settling_to_json(const StepMeasurement& step) {
    Json json = Json::object();
    for (std::size_t i = 0; i < settle_bands_percent.size(); ++i)
        json[shortest(settle_bands_percent[i])] = 1e3 * step.settle[i].value();
    return json;
}

Json ledger_entry_to_json(const LedgerEntry& entry) {
    Json json = Json::object();
    if (entry.band > 0) json["band"] = entry.band;
    if (entry.to.value() > 0.0) {
        json["speed_from_deg_s"] = entry.from.value();
        json["speed_to_deg_s"] = entry.to.value();
    }
    json["filter"] = entry.filter;
    json["dc_delay_ms"] = 1e3 * entry.dc_delay.value();
    json["ramp_delay_ms"] = milliseconds_or_null(entry.ramp_delay);
    json["settle_ms"] = entry.step ? settling_to_json(*entry.step) : Json(nullptr);
    json["overshoot_percent"] = entry.step ? Json(entry.step->overshoot_percent) : Json(nullptr);
    json["phase_lag_deg"] = entry.phase_lag_deg ? Json(*entry.phase_lag_deg) : Json(nullptr);
    json["crossover_db"] = entry.crossover_db ? Json(*entry.crossover_db) : Json(nullptr);
    return json;
}

}  // namespace ripplenotch
