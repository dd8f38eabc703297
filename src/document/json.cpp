// SPDX-License-Identifier: MIT
#include "document/json.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "document/recording_fields.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/version.hpp"
#include "ripplenotch/figure/visible_text.hpp"

namespace ripplenotch {

Json document_head(std::string_view kind, const Provenance& provenance) {
    Json json;
    json["schema"] = fmt::format("ripplenotch/{}/1", kind);
    json["tool"] = tool_name;
    json["version"] = version();
    json["command"] = provenance.command;
    json["inputs"] = Json::array();
    for (const InputRecord& input : provenance.inputs) {
        Json entry = {{"name", input.name}};
        if (!input.sha256.empty()) entry["sha256"] = input.sha256;
        if (input.rows) entry["rows"] = *input.rows;
        json["inputs"].push_back(entry);
    }
    add_recordings(json, provenance.recordings);
    return json;
}

namespace {

bool is_time(std::string_view name) { return name.ends_with("_s") && !name.ends_with("deg_s"); }

void round_fitted(Json& json) {
    if (json.is_number_float()) {
        json = to_digits(json.get<double>());
    } else if (json.is_object()) {
        for (auto& [name, value] : json.items()) {
            if (!is_time(name)) round_fitted(value);
        }
    } else if (json.is_array()) {
        for (Json& value : json) round_fitted(value);
    }
}

}  // namespace

std::string to_fitted_text(Json json) {
    round_fitted(json);
    return to_text(json);
}

std::string to_text(const Json& json) {
    // Names of files and columns may hold bytes that are not UTF-8; they are replaced rather than refused.
    return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

namespace {

// Where a file of this kind comes from.
std::string_view written_by(std::string_view kind) {
    constexpr std::array<std::pair<std::string_view, std::string_view>, 5> writers = {
        {{"joint", "identify --json"},
         {"joints", "identify --joint all --json"},
         {"table", "design --json"},
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

// The opening of the line that is no JSON.
std::string opening_of(std::string_view text) {
    constexpr std::size_t most = 20;
    if (text.empty()) return "an empty file";
    const std::string_view line = text.substr(0, text.find('\n'));
    return fmt::format("'{}{}', which is not JSON", visible_text(line.substr(0, most)),
                       line.size() > most ? "..." : "");
}

}  // namespace

Json parse_document(std::string_view text, const std::string& source, std::string_view kind) {
    Json json;
    try {
        json = Json::parse(text);
    } catch (const Json::parse_error& error) {
        const std::size_t at = std::min<std::size_t>(error.byte == 0 ? 0 : error.byte - 1, text.size());
        const std::string_view before = text.substr(0, at);
        const auto line = 1 + std::count(before.begin(), before.end(), '\n');
        const std::size_t line_start =
            before.rfind('\n') == std::string_view::npos ? 0 : before.rfind('\n') + 1;
        raise<DataError>("{}:{}:{}: read {}, expected schema {}", source, line, at - line_start + 1,
                         opening_of(text.substr(std::min(line_start, text.size()))), wanted(kind));
    }
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

}  // namespace ripplenotch
