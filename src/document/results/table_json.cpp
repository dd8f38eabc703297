// SPDX-License-Identifier: MIT
#include "ripplenotch/document/table_json.hpp"

#include <array>
#include <cmath>

#include "document/fields/fields.hpp"
#include "document/fields/result_fields.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/files.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/design/candidate_table.hpp"

namespace ripplenotch {
namespace {

// Sections must agree to the rounding of one tangent and one cosine in another mathematics library.
constexpr double section_tolerance = 1e-12;
constexpr double figure_tolerance = 1e-6;  // dB, per cent, and a share of the delay

std::vector<double> each_to_digits(std::vector<double> values) {
    for (double& value : values) value = to_digits(value);
    return values;
}

Json depth_to_json(double depth_db) { return depth_db >= infinite_depth_db ? Json(nullptr) : Json(depth_db); }

Json band_to_json(const Band& band) {
    Json notches = Json::array();
    for (const CandidateNotch& notch : band.notches) {
        const Biquad& f = notch.section;
        Json entry = Json::object();
        entry["order"] = notch.order.value();
        entry["center_hz"] = notch.notch.center.value();
        entry["q"] = notch.notch.q;
        entry["depth_db"] = depth_to_json(notch.notch.depth_db);
        entry["sos"] = {f.b0, f.b1, f.b2, 1.0, f.a1, f.a2};
        notches.push_back(std::move(entry));
    }
    Json json = Json::object();
    json["number"] = band.number;
    json["speed_from_deg_s"] = band.from.value();
    json["speed_to_deg_s"] = band.to.value();
    json["notches"] = std::move(notches);
    // Figures for people: what follows from the notches, to the digits on which processors agree.
    json["dc_delay_ms"] = to_digits(1e3 * band.dc_delay.value());
    json["settle_ms"] = to_digits(1e3 * band.settle.value());
    json["settle_band_percent"] = band.settle_band_percent;
    json["overshoot_percent"] = to_digits(band.overshoot_percent);
    json["worst_attenuation_db"] = each_to_digits(band.worst_attenuation_db);
    json["held_attenuation_db"] = to_digits(band.held_attenuation_db);
    if (!band.predicted_residual_nm.empty())
        json["predicted_residual_nm"] = each_to_digits(band.predicted_residual_nm);
    return json;
}

Json note_to_json(const DesignNote& note) {
    Json json = Json::object();
    json["min_attenuation_db"] = note.min_attenuation_db ? Json(*note.min_attenuation_db) : Json(nullptr);
    json["max_delay_ms"] = note.max_delay ? Json(1e3 * note.max_delay->value()) : Json(nullptr);
    json["reason"] = note.reason;
    json["no_notch_below_deg_s"] = note.slowest ? Json(note.slowest->value()) : Json(nullptr);
    return json;
}

template <class Choice, std::size_t n>
Choice choice_at(Fields& fields, std::string_view name, const std::array<Choice, n>& choices,
                 std::string_view (*name_of)(Choice)) {
    const std::string text = fields.text(name);
    std::string known;
    for (const Choice choice : choices) {
        if (name_of(choice) == text) return choice;
        known += fmt::format("{}{}", known.empty() ? "" : ", ", name_of(choice));
    }
    raise<DataError>("{} is \"{}\", expected one of {}", fields.where(name), text, known);
}

// What a figure depends on may have been edited by hand; then the figure, or the section, would lie.
void compare(const Fields& fields, std::string_view name, double stored, double computed, double tolerance) {
    if (std::abs(stored - computed) <= tolerance) return;
    raise<DataError>(
        "{} is {}, but the table's own bands and notches give {}; run 'ripplenotch design' again instead "
        "of editing the file",
        fields.where(name), shortest(stored), shortest(computed));
}

void compare_list(Fields& fields, std::string_view name, const std::vector<double>& computed) {
    const std::vector<double> stored = fields.numbers(name);
    if (stored.size() != computed.size()) {
        raise<DataError>("{} has {} entries, expected {}", fields.where(name), stored.size(),
                         computed.size());
    }
    for (std::size_t i = 0; i < stored.size(); ++i)
        compare(fields, fmt::format("{}[{}]", name, i), stored[i], computed[i], figure_tolerance);
}

CandidateNotch notch_from_json(const Json& json, const std::string& source, const std::string& path,
                               const TableSpec& spec) {
    Fields fields(json, source, path);
    CandidateNotch notch;
    notch.order = Order(fields.number("order"));
    notch.notch.center = Hertz(fields.number("center_hz"));
    notch.notch.q = fields.number("q");
    notch.notch.depth_db = fields.find("depth_db") == nullptr ? infinite_depth_db : fields.number("depth_db");
    notch.notch.width = spec.width;
    const std::vector<double> sos = fields.numbers("sos");
    if (sos.size() != 6) {
        raise<DataError>("{} has {} numbers, expected 6: b0, b1, b2, 1, a1, a2", fields.where("sos"),
                         sos.size());
    }
    try {
        notch.section = design_notch(notch.notch, spec.sample_rate);
    } catch (const UsageError& error) {
        raise<DataError>("{}: {}: {}", source, path, error.what());
    }
    const Biquad& f = notch.section;
    const std::array<double, 6> computed = {f.b0, f.b1, f.b2, 1.0, f.a1, f.a2};
    for (std::size_t i = 0; i < computed.size(); ++i) {
        compare(fields, fmt::format("sos[{}]", i), sos[i], computed[i], section_tolerance);
    }
    // The stored digits are what runs, so that a table filters alike on every machine.
    notch.section = {sos[0], sos[1], sos[2], sos[4], sos[5]};
    fields.finish();
    return notch;
}

Band band_from_json(const Json& json, const std::string& source, const std::string& path, TableSpec& spec,
                    TableWork& work) {
    Fields fields(json, source, path);
    Band band;
    const double number = fields.number("number");
    if (number < 1.0 || number > 1e6 || number != std::floor(number)) {
        raise<DataError>("{} is {}, expected 1, 2, 3, ...", fields.where("number"), shortest(number));
    }
    band.number = static_cast<int>(number);
    band.from = DegPerSec(fields.number("speed_from_deg_s"));
    band.to = DegPerSec(fields.number("speed_to_deg_s"));
    const Json& notches = fields.list("notches", most_orders);
    for (std::size_t i = 0; i < notches.size(); ++i) {
        band.notches.push_back(
            notch_from_json(notches[i], source, fmt::format("{}.notches[{}]", path, i), spec));
    }
    spec.settle_band_percent = fields.number("settle_band_percent");
    try {
        check_ripple(spec);
        work.add(band, spec.settle_band_percent);
        measure_band(band, spec);
    } catch (const UsageError& error) {
        raise<DataError>("{}: {}: {}", source, path, error.what());
    }
    compare(fields, "dc_delay_ms", fields.number("dc_delay_ms"), 1e3 * band.dc_delay.value(),
            figure_tolerance);
    // Rounding may move the settling time by a sample.
    compare(fields, "settle_ms", fields.number("settle_ms"), 1e3 * band.settle.value(),
            1.5e3 / spec.sample_rate.value());
    compare(fields, "overshoot_percent", fields.number("overshoot_percent"), band.overshoot_percent,
            figure_tolerance);
    compare_list(fields, "worst_attenuation_db", band.worst_attenuation_db);
    if (fields.has("held_attenuation_db")) {
        compare(fields, "held_attenuation_db", fields.number("held_attenuation_db"), band.held_attenuation_db,
                figure_tolerance);
    }
    if (fields.has("predicted_residual_nm"))
        compare_list(fields, "predicted_residual_nm", band.predicted_residual_nm);
    fields.finish();
    return band;
}

}  // namespace

std::string table_to_json(const CandidateTable& table, const Provenance& provenance, const DesignNote& note) {
    const TableSpec& spec = table.spec();
    Json json = document_head("table", provenance);
    json["sample_rate_hz"] = spec.sample_rate.value();
    json["gear_ratio"] = spec.gear_ratio.value();
    json["orders"] = Json::array();
    for (const Order order : spec.orders) list_in(json, "orders").push_back(order.value());
    if (note.gear) json["gear"] = gear_to_json(note.gear);
    if (spec.ratio_error > 0.0) json["gear_ratio_error_percent"] = 100.0 * spec.ratio_error;
    if (!spec.amplitude_nm.empty()) json["amplitude_nm"] = spec.amplitude_nm;
    if (!note.reason.empty()) json["designed_for"] = note_to_json(note);
    json["width"] = width_rule_name(spec.width);
    json["bands"] = Json::array();
    for (const Band& band : table.bands()) list_in(json, "bands").push_back(band_to_json(band));
    json["below_first_band"] = outside_rule_name(spec.below);
    json["above_last_band"] = outside_rule_name(spec.above);
    return to_text(json);
}

CandidateTable table_from_json(std::string_view text, const std::string& source) {
    const Json json = parse_document(text, source, "table");
    Fields fields(json, source, "");
    fields.ignore_head();
    fields.ignore({"gear", "designed_for"});
    TableSpec spec;
    spec.sample_rate = Hertz(fields.number("sample_rate_hz"));
    spec.gear_ratio = GearRatio(fields.number("gear_ratio"));
    static_cast<void>(fields.list("orders", most_orders));
    for (const double order : fields.numbers("orders")) spec.orders.emplace_back(order);
    if (fields.has("gear_ratio_error_percent"))
        spec.ratio_error = fields.number("gear_ratio_error_percent") / 100.0;
    if (fields.has("amplitude_nm")) spec.amplitude_nm = fields.numbers("amplitude_nm");
    spec.width =
        choice_at(fields, "width", std::array{WidthRule::analog, WidthRule::digital}, width_rule_name);
    constexpr std::array rules = {OutsideRule::pass, OutsideRule::hold, OutsideRule::fade};
    spec.below = choice_at(fields, "below_first_band", rules, outside_rule_name);
    spec.above = choice_at(fields, "above_last_band", rules, outside_rule_name);
    const Json& rows = fields.list("bands", most_bands);
    fields.finish();
    std::vector<Band> bands;
    TableWork work;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        bands.push_back(band_from_json(rows[i], source, fmt::format("bands[{}]", i), spec, work));
    }
    if (!bands.empty() && !bands.front().notches.empty()) {
        spec.q = bands.front().notches.front().notch.q;
        spec.depth_db = bands.front().notches.front().notch.depth_db;
    }
    try {
        return CandidateTable::from_bands(std::move(spec), std::move(bands));
    } catch (const UsageError& error) {
        raise<DataError>("{}: {}", source, error.what());
    }
}

CandidateTable load_table(const std::string& path) {
    return table_from_json(read_all(path), path == "-" ? "standard input" : path);
}

bool one_q_a_band(const CandidateTable& table) {
    for (const Band& band : table.bands())
        for (const CandidateNotch& notch : band.notches)
            if (notch.notch.q != band.notches.front().notch.q) return false;
    return true;
}

std::string table_to_csv(const CandidateTable& table) {
    std::string csv = "number,speed_from_deg_s,speed_to_deg_s";
    const std::size_t orders = table.spec().orders.size();
    for (std::size_t i = 1; i <= orders; ++i) csv += fmt::format(",center_{}_hz", i);
    const bool one_q = one_q_a_band(table);
    if (one_q) csv += ",q";
    for (std::size_t i = 1; !one_q && i <= orders; ++i) csv += fmt::format(",q_{}", i);
    csv += ",dc_delay_ms,settle_ms,overshoot_percent";
    for (std::size_t i = 1; i <= orders; ++i) csv += fmt::format(",worst_attenuation_{}_db", i);
    csv += "\n";
    for (const Band& band : table.bands()) {
        csv += fmt::format("{},{},{}", band.number, shortest(band.from.value()), shortest(band.to.value()));
        for (const CandidateNotch& notch : band.notches) csv += "," + shortest(notch.notch.center.value());
        for (std::size_t i = 0; i < (one_q ? 1 : orders); ++i) csv += "," + shortest(band.notches[i].notch.q);
        csv += fmt::format(",{:.3f},{:.3f},{:.3f}", 1e3 * band.dc_delay.value(), 1e3 * band.settle.value(),
                           band.overshoot_percent);
        for (const double worst : band.worst_attenuation_db) csv += fmt::format(",{:.2f}", worst);
        csv += "\n";
    }
    return csv;
}

}  // namespace ripplenotch
