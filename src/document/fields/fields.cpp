// SPDX-License-Identifier: MIT
#include "document/fields/fields.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "document/json/json.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/files.hpp"
#include "ripplenotch/core/progress.hpp"
#include "ripplenotch/document/provenance.hpp"

namespace ripplenotch {

InputRecord input_record(const std::string& path) {
    if (path == "-") return {"-", "", std::nullopt};
    return {path, sha256_as_read(path), std::nullopt};
}

void describe(auto& archive, Is<InputRecord> auto& input) {
    archive("name", input.name);
    archive("sha256", input.sha256, if_any);
    archive("rows", input.rows, if_any);
}

void describe(JsonWriter& json, const Gap& gap) {
    json("row", gap.row);
    json("from_s", gap.from_s);
    json("to_s", gap.to_s);
}

void describe(JsonWriter& json, const RateChange& change) {
    json("row", change.row);
    json("time_s", change.time_s);
    json("from_hz", change.from, fitted);
    json("to_hz", change.to, fitted);
}

void describe(JsonWriter& json, const Assumption& one) {
    json("about", one.about);
    json("assumed", one.assumed);
    json("reason", one.reason);
    json("settle_with", one.settle_with, null_if_empty);
}

void describe(JsonWriter& json, const RowsOutside& outside) {
    json("before", outside.before);
    json("after", outside.after);
    json("from_s", outside.from_s);
    json("to_s", outside.to_s);
    json("zero_s", outside.zero_s);
}

void describe(JsonWriter& json, const LookedAt& looked_at) {
    json("rows", looked_at.rows);
    json("pieces", looked_at.pieces);
}

void describe(JsonWriter& json, const Recording& recording) {
    const ClockFacts& clock = recording.clock;
    const auto timed = [&](const Hertz& rate) { return clock.nominal_rate.value() > 0.0 ? &rate : nullptr; };
    json("source", recording.source);
    json("joint", recording.joint, null_if_empty);
    // Numbers that are named _nm are in it.
    if (recording.torque_unit != "Nm") json("torque_unit", recording.torque_unit);
    json("rows", recording.rows());
    json("nominal_rate_hz", timed(clock.nominal_rate), fitted);
    json("mean_rate_hz", timed(clock.mean_rate), fitted);
    json("rate_stated", clock.stated);
    json("gap_count", clock.gap_count);
    json("gaps", clock.gaps);
    json("rate_changes", clock.rate_changes);
    json("rows_left_out", clock.rows_left_out);
    json("repeated_times", clock.repeated_times);
    json("held_samples", recording.held.count);
    json("longest_hold", recording.held.longest);
    json.group("angle", [&](JsonWriter& angle) {
        angle("source", source_name(recording.angle.source()));
        angle("reason", recording.angle.reason());
        if (recording.angle.contradicted) angle("until_row", recording.angle.contradicted->row);
    });
    json("assumptions", recording.assumptions);
    json("inferences", recording.inferences);
    json("looked_at", recording.looked_at, if_any);
    json("rows_outside", recording.outside, if_any);
}

void describe(JsonWriter& json, const DrivenTorque& drive) {
    json("delay_s", drive.delay_s, six);
    json("ci95_s", drive.delay_95_s, six);
    json("rms_nm", drive.rms_nm, six);
    json("limited", drive.limited);
}

void add_recordings(JsonWriter& json, std::span<const Recording> recordings) {
    if (recordings.size() == 1) json("recording", recordings.front());
    if (recordings.size() > 1) json("recordings", recordings);
}

void add_head(JsonWriter& json, std::string_view kind, const Provenance& provenance) {
    json("schema", fmt::format("ripplenotch/{}/1", kind));
    json("tool", tool_name);
    json("version", version());
    json("command", provenance.command);
    json("inputs", provenance.inputs);
    add_recordings(json, provenance.recordings);
}

void ignore_head(JsonReader& reader) {
    for (const std::string_view name : {"schema", "tool", "version", "command"})
        if (reader.has(name)) static_cast<void>(reader.text(name));
    std::vector<InputRecord> inputs;
    reader("inputs", inputs, if_there);
    reader.ignore({"recording", "recordings"});
}

namespace {

// Where a file of this kind comes from.
std::string_view written_by(std::string_view kind) {
    constexpr std::array<std::pair<std::string_view, std::string_view>, 6> writers = {
        {{"joint", "identify --json"},
         {"joints", "identify --joint all --json"},
         {"table", "design --json"},
         {"map", "map -o map.json"},
         {"model", "diagnose --improved-model model.json"},
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
    constexpr std::array kinds = {
        "comparison", "comparisons",    "diagnoses",       "diagnosis",  "effects", "export",
        "figure",     "info",           "joint",           "joints",     "map",     "metrics",
        "model",      "recommendation", "recommendations", "simulation", "spectra", "spectrum",
        "table",      "track",          "tracks",          "trend"};
    constexpr std::string_view wanted_of_any =
        "a result of ripplenotch such as joint.json or what --json prints";
    Json json = read_json(text, source, wanted_of_any);
    const auto schema = json.is_object() ? json.find("schema") : json.end();
    if (!json.is_object() || schema == json.end() || !schema->is_string())
        raise<DataError>("{}: read no \"schema\" field, expected {}", source, wanted_of_any);
    for (const std::string kind : kinds) {
        if (*schema != fmt::format("ripplenotch/{}/1", kind)) continue;
        JsonReader head(json, source, "");
        ignore_head(head);
        return {kind, std::move(json)};
    }
    raise<DataError>("{}: read schema \"{}\", expected {}", source, schema->get<std::string>(),
                     wanted_of_any);
}

namespace {

constexpr std::array<std::string_view, 5> head_names = {"schema", "tool", "version", "command", "inputs"};

void add_inputs(Json& all, const Json& more) {
    for (const Json& input : more)
        if (std::find(all.begin(), all.end(), input) == all.end()) all.push_back(input);
}

}  // namespace

std::string joint_documents_text(std::string_view kind, std::span<const JointDocument> documents) {
    Json whole = Json::object(), inputs = Json::array(), joints = Json::array();
    for (const JointDocument& document : documents) {
        const Json one = Json::parse(document.text);
        Json& entry = joints.emplace_back(Json::object());
        entry["joint"] = document.joint;
        for (const auto& [name, value] : one.items()) {
            const bool in_head = std::find(head_names.begin(), head_names.end(), name) != head_names.end();
            if (name == "inputs")
                add_inputs(inputs, value);
            else if (in_head)
                whole[name] = value;
            else
                entry[name] = value;
        }
    }
    whole["schema"] = fmt::format("ripplenotch/{}/1", kind);
    whole["inputs"] = std::move(inputs);
    whole["joints"] = std::move(joints);
    return to_text(whole);
}

}  // namespace ripplenotch
