// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <filesystem>

#include "core/matrices/least_squares.hpp"
#include "document/fields/fields.hpp"
#include "document/json/json.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/files.hpp"
#include "ripplenotch/document/map_json.hpp"

namespace ripplenotch {

namespace {

constexpr std::size_t most_speeds = 64, most_turn_harmonics = 8, most_map_orders = 64;

std::optional<MapFinding> map_finding_of(std::string_view name) {
    for (const MapFinding one :
         {MapFinding::mapped, MapFinding::nothing, MapFinding::unclear, MapFinding::too_little})
        if (map_finding_name(one) == name) return one;
    return std::nullopt;
}

std::size_t at_most(Fields& fields, std::string_view name, std::size_t least, std::size_t most) {
    const std::size_t value = fields.whole(name);
    if (value < least || value > most)
        raise<DataError>("{} is {}, expected {} to {}", fields.where(name), value, least, most);
    return value;
}

MapRange range_at(Fields& fields, std::string_view name) {
    const std::vector<double> ends = fields.numbers(name);
    if (ends.size() != 2 || !(ends[0] <= ends[1]))
        raise<DataError>("{} is not two numbers, the lower one first", fields.where(name));
    return {ends[0], ends[1]};
}

// Rising, and not more than a list may hold.
std::vector<double> rising_at(Fields& fields, std::string_view name, double least, std::size_t fewest,
                              std::size_t most) {
    std::vector<double> values = fields.numbers(name);
    const bool rises = std::is_sorted(values.begin(), values.end(), std::less_equal<>());
    if (values.size() < fewest || values.size() > most || !rises ||
        (!values.empty() && !(values.front() >= least))) {
        raise<DataError>("{} is not {} to {} numbers from {} on, each above the one before",
                         fields.where(name), fewest, most, least);
    }
    return values;
}

MapForm form_from_json(Fields& fields) {
    MapForm form;
    fields.ignore({"words"});
    form.speeds_deg_s = rising_at(fields, "speeds_deg_s", 0.0, 1, most_speeds);
    form.directions = at_most(fields, "directions", 1, 2);
    form.turn_harmonics = at_most(fields, "turn_harmonics", 0, most_turn_harmonics);
    form.by_load = fields.flag("by_load");
    form.by_temperature = fields.has("by_temperature") && fields.flag("by_temperature");
    if (fields.has("second_comb")) {
        const double side = fields.number("second_comb");
        if (std::abs(side) != 1.0)
            raise<DataError>("{} is {}, expected 1 or -1", fields.where("second_comb"), side);
        form.second_comb = side > 0.0 ? 1 : -1;
    }
    fields.finish();
    return form;
}

void coefficients_from_json(Fields& fields, MapFit& fit) {
    const std::size_t columns = fit.map.form.columns();
    std::vector<std::complex<double>> values, errors;
    fields.each("coefficients", [&](Fields& entry) {
        entry.ignore({"order", "column"});
        values.emplace_back(entry.number("cosine_nm"), entry.number("sine_nm"));
        errors.emplace_back(entry.number("cosine_ci95_nm") / normal_95_errors,
                            entry.number("sine_ci95_nm") / normal_95_errors);
    });
    if (values.size() != columns * fit.map.orders.size()) {
        raise<DataError>("{}: {} values, expected {} for each of {} orders", fields.where("coefficients"),
                         values.size(), columns, fit.map.orders.size());
    }
    for (auto at = std::ptrdiff_t{0}; at < std::ssize(values); at += static_cast<std::ptrdiff_t>(columns)) {
        const auto to = at + static_cast<std::ptrdiff_t>(columns);
        fit.map.values.emplace_back(values.begin() + at, values.begin() + to);
        fit.errors.emplace_back(errors.begin() + at, errors.begin() + to);
    }
}

void scores_from_json(Fields& fields, MapFit& fit) {
    fields.each("left_out", [&](Fields& entry) {
        fit.scores.push_back({entry.number("order"), entry.flag("in_map"), entry.number("ripple_nm"),
                              entry.number("noise_nm"), entry.number("left_nm"),
                              entry.number("predicted_share"),
                              entry.has("false_alarm") ? entry.number("false_alarm") : 1.0,
                              entry.has("detectable_nm") ? entry.number("detectable_nm") : 0.0});
    });
    fields.each("agreement", [&](Fields& entry) {
        fit.agreement.push_back({entry.whole("log"), entry.number("order"), entry.number("amplitude_ratio"),
                                 entry.number("amplitude_error"), entry.number("phase_deg"),
                                 entry.number("phase_error_deg"), entry.flag("agrees")});
    });
}

void map_fields(Fields& fields, MapFit& fit) {
    RippleMap& map = fit.map;
    map.joint = fields.text("joint");
    map.gear_ratio = GearRatio(fields.number("gear_ratio"));
    if (!(map.gear_ratio.value() > 0.0))
        raise<DataError>("{} is {}, expected a positive number", fields.where("gear_ratio"),
                         map.gear_ratio.value());
    map.zero_deg = fields.number("zero_deg");
    fit.anchored = fields.text("angle") == "position";
    Fields form = fields.object("form");
    map.form = form_from_json(form);
    Fields range = fields.object("range");
    map.speeds_deg_s = range_at(range, "speed_deg_s");
    map.positions_deg = range_at(range, "position_deg");
    map.loads_nm = range_at(range, "load_nm");
    if (map.form.by_temperature) {
        map.temperatures_degc = range_at(range, "temperature_degc");
        map.temperature_column = fields.text("temperature_column");
    }
    range.finish();
    for (const double order : rising_at(fields, "orders", 1e-9, 0, most_map_orders))
        map.orders.emplace_back(order);
    map.spread_nm = fields.numbers("spread_nm");
    if (map.spread_nm.size() != map.orders.size())
        raise<DataError>("{}: {} numbers for {} orders", fields.where("spread_nm"), map.spread_nm.size(),
                         map.orders.size());
}

}  // namespace

MapFit map_from_json(std::string_view text, const std::string& source) {
    const Json json = parse_document(text, source, "map");
    Fields fields(json, source, "");
    fields.ignore_head();
    fields.ignore({"verdict"});
    MapFit fit;
    fit.finding = fields.named("finding", map_finding_of);
    fit.doubt = fields.text("doubt");
    fit.conclusive = fields.flag("conclusive");
    map_fields(fields, fit);
    coefficients_from_json(fields, fit);
    scores_from_json(fields, fit);
    fit.windows = fields.whole("windows");
    fit.blocks = fields.whole("blocks");
    fit.notes = fields.texts("notes");
    fields.finish();
    return fit;
}

MapFit load_map(const std::string& path) {
    return map_from_json(read_all(path), path == "-" ? "standard input" : path);
}

bool is_map(const std::string& path) {
    constexpr std::size_t head = 200;
    std::error_code failed;
    if (!std::filesystem::is_regular_file(path, failed)) return false;
    return read_all(path).substr(0, head).find("ripplenotch/map/1") != std::string::npos;
}

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
