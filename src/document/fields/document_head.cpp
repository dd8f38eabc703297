// SPDX-License-Identifier: MIT
#include "document/fields/document_head.hpp"

#include <array>
#include <utility>

#include "document/fields/fields.hpp"
#include "document/fields/recording_fields.hpp"
#include "document/json/json_door.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/version.hpp"

namespace ripplenotch {

Json document_head(std::string_view kind, const Provenance& provenance) {
    Json json = Json::object();
    json["schema"] = fmt::format("ripplenotch/{}/1", kind);
    json["tool"] = tool_name;
    json["version"] = version();
    json["command"] = provenance.command;
    json["inputs"] = Json::array();
    for (const InputRecord& input : provenance.inputs) {
        Json entry = {{"name", input.name}};
        if (!input.sha256.empty()) entry["sha256"] = input.sha256;
        if (input.rows) entry["rows"] = *input.rows;
        list_in(json, "inputs").push_back(entry);
    }
    add_recordings(json, provenance.recordings);
    return json;
}

namespace {

// Where a file of this kind comes from.
std::string_view written_by(std::string_view kind) {
    constexpr std::array<std::pair<std::string_view, std::string_view>, 6> writers = {
        {{"joint", "identify --json"},
         {"joints", "identify --joint all --json"},
         {"table", "design --json"},
         {"map", "map -o map.json"},
         {"model", "diagnose -o model.json"},
         {"figure", "--plot FILE.json of any command"}}};
    for (const auto& [name, writer] : writers) {
        if (name == kind) return writer;
    }
    return "--json";
}

// "a table, as 'design -o table.json' writes it"
std::string wanted(std::string_view kind) {
    return fmt::format("\"ripplenotch/{}/1\", as '{}' writes it", kind, written_by(kind));
}

}  // namespace

Json parse_document(std::string_view text, const std::string& source, std::string_view kind) {
    Json json = read_json(text, source, "schema " + wanted(kind));
    const std::string expected = fmt::format("ripplenotch/{}/1", kind);
    const auto schema = json.is_object() ? json.find("schema") : json.end();
    if (!json.is_object() || schema == json.end() || !schema->is_string()) {
        raise<DataError>("{}: read no \"schema\" field, expected {}", source, wanted(kind));
    }
    if (*schema != expected) {
        raise<DataError>("{}: read schema \"{}\", expected {}", source, schema->get<std::string>(),
                         wanted(kind));
    }
    return json;
}

AnyDocument parse_any_document(std::string_view text, const std::string& source) {
    constexpr std::array kinds = {"comparison", "diagnoses", "diagnosis", "effects",        "export",
                                  "figure",     "frontier",  "info",      "joint",          "joints",
                                  "map",        "metrics",   "model",     "recommendation", "simulation",
                                  "spectrum",   "table",     "track",     "trend"};
    constexpr std::string_view wanted_of_any =
        "a result of ripplenotch such as joint.json or what --json prints";
    Json json = read_json(text, source, wanted_of_any);
    const auto schema = json.is_object() ? json.find("schema") : json.end();
    if (!json.is_object() || schema == json.end() || !schema->is_string())
        raise<DataError>("{}: read no \"schema\" field, expected {}", source, wanted_of_any);
    for (const std::string kind : kinds) {
        if (*schema != fmt::format("ripplenotch/{}/1", kind)) continue;
        Fields(json, source, "").ignore_head();
        return {kind, std::move(json)};
    }
    raise<DataError>("{}: read schema \"{}\", expected {}", source, schema->get<std::string>(),
                     wanted_of_any);
}

}  // namespace ripplenotch
