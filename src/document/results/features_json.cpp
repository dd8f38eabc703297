// SPDX-License-Identifier: MIT
#include "ripplenotch/document/features_json.hpp"

#include <algorithm>

#include "document/fields/features_fields.hpp"
#include "document/json/json.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/visible_text.hpp"

namespace ripplenotch {
namespace {

void add_descriptors(const FeatureLine& line, Json& json) {
    Json reasons = Json::object();
    for (const Descriptor& one : line.descriptors) {
        json[one.name()] = six_digits(one.value);
        if (one.value && one.ci95)
            json[one.interval_name()] = {six_digits(one.ci95->low), six_digits(one.ci95->high)};
        if (!one.value) reasons[one.name()] = one.reason;
    }
    if (!line.date) reasons["date"] = line.date_source;
    if (!line.temperature_degc) reasons["temperature_degc"] = line.temperature_source;
    if (!line.mix.load_rms_nm)
        reasons["load_rms_nm"] = "the joint has neither inertia nor weight in this log";
    json["not_told"] = reasons;
}

Json feature_line_to_json(const FeatureLine& line) {
    Json json;
    json["schema"] = features_schema;
    json["version"] = line.version;
    json["log"] = line.log;
    json["sha256"] = line.sha256;
    json["robot"] = line.robot;
    json["joint"] = line.joint;
    if (line.failed()) {
        json["error"] = line.error;
        json["error_code"] = line.error_code;
        return json;
    }
    json["date"] = or_null(line.date);
    json["date_source"] = line.date ? line.date_source : "";
    json["temperature_degc"] = six_digits(line.temperature_degc);
    json["temperature_source"] = line.temperature_degc ? line.temperature_source : "";
    json["rows"] = line.rows;
    json["duration_s"] = six_digits(line.duration_s);
    for (const MixField& field : mix_fields) json[field.name] = six_digits(line.mix.*field.value);
    json["reversals"] = line.mix.reversals;
    json["load_rms_nm"] = six_digits(line.mix.load_rms_nm);
    add_descriptors(line, json);
    return json;
}

std::string cell_of(const Json& json) {
    if (json.is_null()) return "";
    std::string text = json.is_string() ? json.get<std::string>()
                                        : json.dump(-1, ' ', false, Json::error_handler_t::replace);
    if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
    std::string quoted = "\"";
    for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
    return quoted + "\"";
}

// Intervals as two columns; the order of first appearance.
std::vector<std::pair<std::string, Json>> cells_of(const FeatureLine& line) {
    std::vector<std::pair<std::string, Json>> cells;
    const Json json = feature_line_to_json(line);
    for (const auto& [name, value] : json.items()) {
        if (name == "schema" || name == "not_told" || name == "error" || name == "error_code") continue;
        if (value.is_array()) {
            cells.emplace_back(name + "_low", value[0]);
            cells.emplace_back(name + "_high", value[1]);
        } else {
            cells.emplace_back(name, value);
        }
    }
    std::string reasons;
    if (const auto told = json.find("not_told"); told != json.end())
        for (const auto& [name, reason] : told->items())
            reasons += (reasons.empty() ? "" : "; ") + name + ": " + reason.get<std::string>();
    cells.emplace_back("not_told", reasons);
    cells.emplace_back("error", line.error);
    return cells;
}

}  // namespace

std::string feature_line_text(const FeatureLine& line) {
    return visible_json(feature_line_to_json(line).dump(-1, ' ', false, Json::error_handler_t::replace)) +
           "\n";
}

std::string features_csv(std::span<const FeatureLine> lines) {
    std::vector<std::string> names;
    std::vector<std::vector<std::pair<std::string, Json>>> rows;
    for (const FeatureLine& line : lines) {
        rows.push_back(cells_of(line));
        for (const auto& [name, value] : rows.back())
            if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
    }
    // What explains the others stands behind them.
    for (const std::string last : {"not_told", "error"}) {
        std::erase(names, last);
        names.push_back(last);
    }
    std::string text;
    for (std::size_t i = 0; i < names.size(); ++i) text += (i == 0 ? "" : ",") + names[i];
    text += "\n";
    for (const auto& row : rows) {
        for (std::size_t i = 0; i < names.size(); ++i) {
            const auto cell =
                std::find_if(row.begin(), row.end(), [&](const auto& one) { return one.first == names[i]; });
            text += (i == 0 ? "" : ",") + (cell == row.end() ? std::string() : cell_of(cell->second));
        }
        text += "\n";
    }
    return text;
}

}  // namespace ripplenotch
