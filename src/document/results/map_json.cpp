// SPDX-License-Identifier: MIT
#include "ripplenotch/document/map_json.hpp"

#include <cmath>

#include "core/matrices/normal_errors.hpp"
#include "document/fields/document_head.hpp"
#include "document/json/json.hpp"

namespace ripplenotch {
namespace {

Json range_to_json(const MapRange& range) { return {range.from, range.to}; }

Json form_to_json(const MapForm& form) {
    Json json = Json::object();
    json["words"] = map_form_words(form);
    json["speeds_deg_s"] = form.speeds_deg_s;
    json["directions"] = form.directions;
    json["turn_harmonics"] = form.turn_harmonics;
    json["by_load"] = form.by_load;
    if (form.by_temperature) json["by_temperature"] = true;
    if (form.second_comb != 0) json["second_comb"] = form.second_comb;
    return json;
}

// One row a value, so that a page shows a table.
Json coefficients_to_json(const MapFit& fit) {
    Json json = Json::array();
    for (std::size_t i = 0; i < fit.map.orders.size(); ++i) {
        for (std::size_t c = 0; c < fit.map.values[i].size(); ++c) {
            json.push_back({{"order", fit.map.orders[i].value()},
                            {"column", map_column_words(fit.map.form, c)},
                            {"cosine_nm", fit.map.values[i][c].real()},
                            {"cosine_ci95_nm", normal_95_errors * fit.errors[i][c].real()},
                            {"sine_nm", fit.map.values[i][c].imag()},
                            {"sine_ci95_nm", normal_95_errors * fit.errors[i][c].imag()}});
        }
    }
    return json;
}

Json scores_to_json(const std::vector<MapOrderScore>& scores) {
    Json json = Json::array();
    for (const MapOrderScore& score : scores) {
        json.push_back({{"order", score.order},
                        {"in_map", score.in_map},
                        {"ripple_nm", score.ripple_nm},
                        {"noise_nm", score.noise_nm},
                        {"left_nm", score.left_nm},
                        {"predicted_share", score.predicted_share},
                        {"false_alarm", score.false_alarm}});
        if (!score.in_map && std::isfinite(score.detectable_nm))
            json.back()["detectable_nm"] = score.detectable_nm;
    }
    return json;
}

Json agreement_to_json(const std::vector<MapAgreement>& agreement) {
    Json json = Json::array();
    for (const MapAgreement& one : agreement) {
        json.push_back({{"log", one.log},
                        {"order", one.order},
                        {"amplitude_ratio", one.amplitude_ratio},
                        {"amplitude_error", one.amplitude_error},
                        {"phase_deg", one.phase_deg},
                        {"phase_error_deg", one.phase_error_deg},
                        {"agrees", one.agrees}});
    }
    return json;
}

}  // namespace

std::string map_text(const MapFit& fit, const Provenance& provenance) {
    Json json = document_head("map", provenance);
    json["verdict"] = map_verdict(fit);
    json["finding"] = map_finding_name(fit.finding);
    json["doubt"] = fit.doubt;
    json["conclusive"] = fit.conclusive;
    json["joint"] = fit.map.joint;
    json["gear_ratio"] = fit.map.gear_ratio.value();
    json["zero_deg"] = fit.map.zero_deg;
    json["angle"] = fit.anchored ? "position" : "integrated velocity";
    json["form"] = form_to_json(fit.map.form);
    json["range"] = {{"speed_deg_s", range_to_json(fit.map.speeds_deg_s)},
                     {"position_deg", range_to_json(fit.map.positions_deg)},
                     {"load_nm", range_to_json(fit.map.loads_nm)}};
    if (fit.map.form.by_temperature) {
        json["range"]["temperature_degc"] = range_to_json(fit.map.temperatures_degc);
        json["temperature_column"] = fit.map.temperature_column;
    }
    json["orders"] = Json::array();
    for (const Order order : fit.map.orders) list_in(json, "orders").push_back(order.value());
    json["spread_nm"] = fit.map.spread_nm;
    json["coefficients"] = coefficients_to_json(fit);
    json["left_out"] = scores_to_json(fit.scores);
    json["agreement"] = agreement_to_json(fit.agreement);
    json["windows"] = fit.windows;
    json["blocks"] = fit.blocks;
    json["notes"] = fit.notes;
    return to_fitted_text(std::move(json));
}

}  // namespace ripplenotch
