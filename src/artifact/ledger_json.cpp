// SPDX-License-Identifier: MIT
#include "artifact/ledger_json.hpp"

#include "ripplenotch/core/number.hpp"

namespace ripplenotch {

Json settling_to_json(const StepMeasurement& step) {
    Json json = Json::object();
    for (std::size_t i = 0; i < settle_bands_percent.size(); ++i)
        json[shortest(settle_bands_percent[i])] = 1e3 * step.settle[i].value();
    return json;
}

Json ledger_entry_to_json(const LedgerEntry& entry) {
    Json json;
    if (entry.band > 0) json["band"] = entry.band;
    if (entry.to.value() > 0.0) {
        json["speed_from_deg_s"] = entry.from.value();
        json["speed_to_deg_s"] = entry.to.value();
    }
    json["filter"] = entry.filter;
    json["dc_delay_ms"] = 1e3 * entry.dc_delay.value();
    json["ramp_delay_ms"] = entry.ramp_delay ? Json(1e3 * entry.ramp_delay->value()) : Json(nullptr);
    json["settle_ms"] = entry.step ? settling_to_json(*entry.step) : Json(nullptr);
    json["overshoot_percent"] = entry.step ? Json(entry.step->overshoot_percent) : Json(nullptr);
    json["phase_lag_deg"] = entry.phase_lag_deg ? Json(*entry.phase_lag_deg) : Json(nullptr);
    json["crossover_db"] = entry.crossover_db ? Json(*entry.crossover_db) : Json(nullptr);
    return json;
}

}  // namespace ripplenotch
