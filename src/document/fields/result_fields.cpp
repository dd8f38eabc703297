// SPDX-License-Identifier: MIT
#include "document/fields/result_fields.hpp"

#include "document/json/json.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/evaluate/contender.hpp"
#include "ripplenotch/evaluate/ledger.hpp"

namespace ripplenotch {

namespace {

constexpr std::string_view simulated = "simulated";

}  // namespace

void put_beside(Json& json, const Diagnosis& diagnosis) {
    for (const GivenValue& value : diagnosis.given) {
        // An arm's values are of combinations of links, which nobody reads one by one.
        if (value.name == simulated) json["simulated"] = {{"scale", six_digits(value.value)}};
    }
    if (diagnosis.residual_in_noise) json["residual_in_noise"] = true;
    if (!diagnosis.setup.empty()) json["setup"] = Json::array();
    for (const SetupFault& fault : diagnosis.setup)
        list_in(json, "setup")
            .push_back({{"fault", setup_fault_name(fault.kind)},
                        {"statement", fault.statement},
                        {"option", fault.option},
                        {"explained_before", six_digits(fault.explained_before)},
                        {"explained_after", six_digits(fault.explained_after)}});
    if (!diagnosis.alignment) return;
    const SimulationLag& lag = *diagnosis.alignment;
    json["alignment"] = {
        {"delay_s", six_digits(lag.delay_s)},
        {"ci95_s", {six_digits(lag.delay_95_s.low), six_digits(lag.delay_95_s.high)}},
        {"correlation", six_digits(lag.correlation)},
        {"clock_error_ppm", lag.clock_error ? six_digits(1e6 * *lag.clock_error) : Json(nullptr)}};
}

void read_beside(Fields& fields, Diagnosis& diagnosis) {
    if (fields.has("residual_in_noise")) diagnosis.residual_in_noise = fields.flag("residual_in_noise");
    if (!fields.has("simulated")) return;
    Fields given = fields.object("simulated");
    diagnosis.given.push_back({std::string(simulated), given.number("scale"), std::nullopt});
    given.finish();
}

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

namespace {

// {"0.5": ms, "1": ms, ...}
Json settling_to_json(const StepMeasurement& step) {
    Json json = Json::object();
    for (std::size_t i = 0; i < settle_bands_percent.size(); ++i)
        json[shortest(settle_bands_percent[i])] = 1e3 * step.settle[i].value();
    return json;
}

}  // namespace

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

namespace {

Json band_json(const BandGap& band) {
    Json to = band.to_hz > 0.0 ? six_digits(band.to_hz) : Json(nullptr);
    return {{"hz", {six_digits(band.from_hz), to}},
            {"torque_nm", six_digits(band.torque_nm)},
            {"beside_given_nm", six_digits(band.beside_given_nm)},
            {"after_nm", six_digits(band.after_nm)}};
}

}  // namespace

void put_decided(Json& json, const Diagnosis& diagnosis) {
    if (!diagnosis.bands.empty()) {
        json["bands"] = Json::array();
        for (const BandGap& band : diagnosis.bands) list_in(json, "bands").push_back(band_json(band));
    }
    if (!diagnosis.accepted.empty()) {
        json["accepted"] = Json::array();
        for (const AcceptedFinding& one : diagnosis.accepted) {
            Json entry{{"effect", one.term.effect->name}, {"status", status_name(one.status)}};
            if (!one.reason.empty()) entry["reason"] = one.reason;
            entry["parameters"] = parameters_json(one.term, one.values);
            list_in(json, "accepted").push_back(std::move(entry));
        }
    }
    if (!diagnosis.next.empty()) json["next"] = diagnosis.next;
}

void read_decided(Fields& fields, Diagnosis& diagnosis) {
    if (fields.has("next")) diagnosis.next = fields.texts("next");
    if (!fields.has("bands")) return;
    fields.each("bands", [&](Fields& entry) {
        const Json& hz = entry.list("hz");
        if (hz.size() != 2 || !hz[0].is_number()) raise<DataError>("{} is no band", entry.where("hz"));
        diagnosis.bands.push_back({hz[0].get<double>(), hz[1].is_number() ? hz[1].get<double>() : 0.0,
                                   entry.number("torque_nm"), entry.number("beside_given_nm"),
                                   entry.number("after_nm")});
    });
}

}  // namespace ripplenotch
