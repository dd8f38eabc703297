// SPDX-License-Identifier: MIT
#include "ripplenotch/document/comparison_json.hpp"

#include "document/fields/document_head.hpp"
#include "document/fields/gear_fields.hpp"
#include "document/fields/ledger_fields.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/evaluate/bench.hpp"

namespace ripplenotch {
namespace {

Json settling_of_method(const MethodFigures& figures) {
    if (!figures.settle_ms) return nullptr;
    Json json = Json::object();
    for (std::size_t i = 0; i < settle_bands_percent.size(); ++i) {
        json[shortest(settle_bands_percent[i])] = (*figures.settle_ms)[i];
    }
    return json;
}

Json method_to_json(const MethodFigures& figures) {
    Json json = Json::object();
    json["method"] = figures.method;
    json["settle_ms"] = settling_of_method(figures);
    json["overshoot_percent"] = or_null(figures.overshoot_percent);
    json["ramp_delay_ms"] = or_null(figures.ramp_delay_ms);
    json["dc_delay_ms"] = or_null(figures.dc_delay_ms);
    json["phase_lag_deg"] = or_null(figures.phase_lag_deg);
    json["crossover_db"] = or_null(figures.crossover_db);
    json["attenuation_db"] = Json::array();
    for (const OrderAttenuation& entry : figures.attenuation) {
        list_in(json, "attenuation_db")
            .push_back({{"order", entry.order}, {"hz", entry.hz}, {"db", or_null(entry.db)}});
    }
    json["ripple_rms_nm"] = or_null(figures.ripple_rms_nm);
    json["residual_rms_nm"] = or_null(figures.residual_rms_nm);
    json["residual_peak_to_peak_nm"] = or_null(figures.residual_peak_to_peak_nm);
    json["switches"] = or_null(figures.switches);
    json["largest_jump_nm"] = or_null(figures.largest_jump_nm);
    json["error_rms_nm"] = or_null(figures.error_rms_nm);
    json["note"] = figures.note;
    json["within_max_delay_from_deg_s"] =
        figures.within_from ? Json(figures.within_from->value()) : Json(nullptr);
    json["ledger"] = Json::array();
    for (const LedgerEntry& entry : figures.ledger)
        list_in(json, "ledger").push_back(ledger_entry_to_json(entry));
    json["switch_ledger"] = Json::array();
    for (const SwitchEntry& entry : figures.switch_ledger)
        list_in(json, "switch_ledger").push_back(switch_entry_to_json(entry));
    return json;
}

Json match_to_json(const LowPassMatch& match) {
    Json json = Json::object();
    json["subject"] = match.subject;
    json["low_pass"] = or_null(match.low_pass);
    json["order"] = match.order;
    json["cutoff_hz"] = match.cutoff ? Json(match.cutoff->value()) : Json(nullptr);
    json["ripple_rms_nm"] = or_null(match.ripple_rms_nm);
    json["attenuation_db"] = or_null(match.attenuation_db);
    json["matched"] = match.clause;
    return json;
}

}  // namespace

std::string comparison_text(const Comparison& comparison, const Provenance& provenance) {
    Json json = document_head("comparison", provenance);
    json["verdict"] = verdict(comparison);
    json["sample_rate_hz"] = comparison.sample_rate.value();
    json["speed_deg_s"] = comparison.speed.value();
    json["step_nm"] = or_null(comparison.step_nm);
    json["ramp_nm_s"] = or_null(comparison.ramp_nm_s);
    json["crossover_hz"] = comparison.crossover ? Json(comparison.crossover->value()) : Json(nullptr);
    json["no_notch_below_deg_s"] =
        comparison.no_notch_below ? Json(comparison.no_notch_below->value()) : Json(nullptr);
    json["gear_ratio"] = comparison.lines ? Json(comparison.lines->ratio.value()) : Json(nullptr);
    json["gear"] = gear_to_json(comparison.lines);
    json["orders"] = Json::array();
    if (comparison.lines) {
        for (const Order order : comparison.lines->orders) list_in(json, "orders").push_back(order.value());
    }
    if (comparison.on_log) {
        json["rows"] = comparison.rows;
        json["windows"] = comparison.windows;
        json["measured_share"] = comparison.measured_share;
    }
    json["match"] = comparison.match ? match_to_json(*comparison.match) : Json(nullptr);
    json["methods"] = Json::array();
    for (const MethodFigures& figures : comparison.methods)
        list_in(json, "methods").push_back(method_to_json(figures));
    return to_fitted_text(std::move(json));
}

}  // namespace ripplenotch
