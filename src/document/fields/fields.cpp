// SPDX-License-Identifier: MIT
#include "document/fields/fields.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "document/json/json.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/files.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/progress.hpp"

namespace ripplenotch {

InputRecord input_record(const std::string& path) {
    if (path == "-") return {"-", "", std::nullopt};
    return {path, sha256_as_read(path), std::nullopt};
}

std::string in_words(const Json& value) {
    constexpr std::size_t most = 40;
    if (value.is_array()) return "a list";
    if (value.is_object()) return "an object";
    const std::string text = value.dump();
    return text.size() <= most ? text : text.substr(0, most) + "...";
}

Fields::Fields(const Json& object, std::string source, std::string path)
    : object_(object), source_(std::move(source)), path_(std::move(path)) {
    if (!object_.is_object()) {
        raise<DataError>("{}: {} is not an object", source_, path_.empty() ? "the document" : path_);
    }
}

std::string Fields::path_of(std::string_view name) const {
    return path_.empty() ? std::string(name) : fmt::format("{}.{}", path_, name);
}

std::string Fields::where(std::string_view name) const {
    return fmt::format("{}: {}", source_, path_of(name));
}

const Json* Fields::find(std::string_view name) {
    seen_.emplace_back(name);
    const auto found = object_.find(std::string(name));
    return found == object_.end() || found->is_null() ? nullptr : &*found;
}

const Json& Fields::at(std::string_view name) {
    const Json* value = find(name);
    if (value == nullptr) raise<DataError>("{} is missing", where(name));
    return *value;
}

double Fields::number(std::string_view name) {
    const Json& value = at(name);
    if (!value.is_number()) raise<DataError>("{} is {}, expected a number", where(name), in_words(value));
    return value.get<double>();
}

std::optional<double> Fields::number_if_any(std::string_view name) {
    if (!has(name)) return std::nullopt;
    return number(name);
}

std::size_t Fields::whole(std::string_view name) {
    constexpr double most = 1e9;
    const double value = number(name);
    if (value < 0.0 || value != std::floor(value) || value > most)
        raise<DataError>("{} is {}, expected a whole number", where(name), value);
    return static_cast<std::size_t>(value);
}

bool Fields::flag(std::string_view name) {
    const Json& value = at(name);
    if (!value.is_boolean()) raise<DataError>("{} is not true or false", where(name));
    return value.get<bool>();
}

std::string Fields::text(std::string_view name) {
    const Json& value = at(name);
    if (!value.is_string()) raise<DataError>("{} is {}, expected a text", where(name), in_words(value));
    return value.get<std::string>();
}

const Json& Fields::list(std::string_view name) {
    const Json& value = at(name);
    if (!value.is_array()) raise<DataError>("{} is not a list", where(name));
    return value;
}

std::vector<double> Fields::numbers(std::string_view name) {
    std::vector<double> values;
    for (const Json& value : list(name)) {
        if (!value.is_number())
            raise<DataError>("{} holds {}, expected numbers", where(name), in_words(value));
        values.push_back(value.get<double>());
    }
    return values;
}

std::vector<std::string> Fields::texts(std::string_view name) {
    std::vector<std::string> values;
    for (const Json& value : list(name)) {
        if (!value.is_string()) raise<DataError>("{} holds {}, expected texts", where(name), in_words(value));
        values.push_back(value.get<std::string>());
    }
    return values;
}

Fields Fields::object(std::string_view name) { return {at(name), source_, path_of(name)}; }

void Fields::refuse_name(std::string_view name, const std::string& word) const {
    raise<DataError>("{} is \"{}\", which is none of its names", where(name), word);
}

const Json& Fields::list(std::string_view name, std::size_t most) {
    const Json& value = list(name);
    if (value.size() > most)
        raise<DataError>("{} has {} entries, expected at most {}", where(name), value.size(), most);
    return value;
}

void Fields::ignore_head() {
    for (const std::string_view name : {"schema", "tool", "version", "command"})
        if (has(name)) static_cast<void>(text(name));
    if (has("inputs")) {
        each("inputs", [](Fields& input) {
            static_cast<void>(input.text("name"));
            if (input.has("sha256")) static_cast<void>(input.text("sha256"));
            if (input.has("rows")) static_cast<void>(input.whole("rows"));
        });
    }
    ignore({"recording", "recordings"});
}

void Fields::ignore(std::initializer_list<std::string_view> names) {
    for (const auto name : names) seen_.emplace_back(name);
}

void Fields::finish() const {
    for (const auto& [name, value] : object_.items()) {
        if (std::find(seen_.begin(), seen_.end(), name) == seen_.end()) {
            raise<DataError>("{} is not a known field; remove it or check its spelling", where(name));
        }
    }
}

namespace {

Json name_or_null(const std::string& name) { return name.empty() ? Json(nullptr) : Json(name); }

void add_clock(Json& json, const ClockFacts& clock) {
    const bool timed = clock.nominal_rate.value() > 0.0;
    json["nominal_rate_hz"] = timed ? Json(to_digits(clock.nominal_rate.value())) : Json(nullptr);
    json["mean_rate_hz"] = timed ? finite_or_null(to_digits(clock.mean_rate.value())) : Json(nullptr);
    json["rate_stated"] = clock.stated;
    json["gap_count"] = clock.gap_count;
    json["gaps"] = gaps_json(clock);
    json["rate_changes"] = Json::array();
    for (const RateChange& change : clock.rate_changes) {
        list_in(json, "rate_changes")
            .push_back({{"row", change.row},
                        {"time_s", change.time_s},
                        {"from_hz", to_digits(change.from.value())},
                        {"to_hz", to_digits(change.to.value())}});
    }
    json["rows_left_out"] = clock.rows_left_out;
    json["repeated_times"] = clock.repeated_times;
}

Json assumptions_json(const std::vector<Assumption>& assumptions) {
    Json json = Json::array();
    for (const Assumption& one : assumptions) {
        json.push_back({{"about", one.about},
                        {"assumed", one.assumed},
                        {"reason", one.reason},
                        {"settle_with", name_or_null(one.settle_with)}});
    }
    return json;
}

Json outside_json(const RowsOutside& outside) {
    const auto number_or_null = [](std::optional<double> value) {
        return value ? Json(*value) : Json(nullptr);
    };
    return {{"before", outside.before},
            {"after", outside.after},
            {"from_s", number_or_null(outside.from_s)},
            {"to_s", number_or_null(outside.to_s)},
            {"zero_s", outside.zero_s}};
}

Json recording_json(const Recording& recording) {
    Json json = Json::object();
    json["source"] = recording.source;
    json["joint"] = name_or_null(recording.joint);
    json["rows"] = recording.rows();
    add_clock(json, recording.clock);
    json["held_samples"] = recording.held.count;
    json["longest_hold"] = recording.held.longest;
    json["angle"] = {{"source", source_name(recording.angle.source())}, {"reason", recording.angle.reason()}};
    if (recording.angle.contradicted) json["angle"]["until_row"] = recording.angle.contradicted->row;
    json["assumptions"] = assumptions_json(recording.assumptions);
    json["inferences"] = assumptions_json(recording.inferences);
    if (recording.looked_at)
        json["looked_at"] = {{"rows", recording.looked_at->rows}, {"pieces", recording.looked_at->pieces}};
    if (recording.outside) json["rows_outside"] = outside_json(*recording.outside);
    return json;
}

}  // namespace

Json gaps_json(const ClockFacts& clock) {
    Json json = Json::array();
    for (const Gap& gap : clock.gaps)
        json.push_back({{"row", gap.row}, {"from_s", gap.from_s}, {"to_s", gap.to_s}});
    return json;
}

void add_recordings(Json& json, std::span<const Recording> recordings) {
    if (recordings.size() == 1) json["recording"] = recording_json(recordings.front());
    if (recordings.size() <= 1) return;
    json["recordings"] = Json::array();
    for (const Recording& one : recordings) list_in(json, "recordings").push_back(recording_json(one));
}

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

namespace {

Json mjcf_json(const MjcfAccount& mjcf) {
    Json holds = Json::array(), not_held = Json::array();
    for (const MjcfPart& part : mjcf.holds) holds.push_back({{"effect", part.effect}, {"as", part.words}});
    for (const MjcfPart& part : mjcf.not_held)
        not_held.push_back({{"effect", part.effect}, {"reason", part.words}});
    return {{"file", mjcf.file},
            {"holds", holds},
            {"not_held", not_held},
            {"gap_before_nm", six_digits(mjcf.before_nm)},
            {"gap_after_nm", six_digits(mjcf.after_nm)}};
}

Json plan_json(const MotionPlan& plan, const std::string& file) {
    Json questions = Json::array();
    for (const PlanQuestion& one : plan.questions)
        questions.push_back({{"effect", one.effect},
                             {"rival", one.rival.empty() ? Json(nullptr) : Json(one.rival)},
                             {"open", one.open},
                             {"gain_before", six_digits(one.gain_before)},
                             {"gain", six_digits(one.gain)}});
    return {{"file", file},
            {"duration_s", plan.duration().value()},
            {"decides", plan.decides},
            {"motions", plan.motions},
            {"questions", questions}};
}

}  // namespace

void put_written(Json& json, const DiagnosisWritten& written) {
    if (written.mjcf != nullptr) json["mjcf"] = mjcf_json(*written.mjcf);
    if (written.plan != nullptr)
        json["plan"] = plan_json(*written.plan, written.plan_file);
    else if (!written.plan_file.empty())
        json["plan"] = nullptr;
}

void put_angle(Json& json, const Diagnosis& diagnosis) {
    if (!diagnosis.angle) return;
    const auto& start = diagnosis.angle->validation_start_deg;
    json["angle"] = {{"walk_deg", six_digits(diagnosis.angle->walk_deg)},
                     {"validation_start_deg", start ? six_digits(*start) : Json(nullptr)}};
}

void read_angle(Fields& fields, Diagnosis& diagnosis) {
    if (!fields.has("angle")) return;
    Fields angle = fields.object("angle");
    AngleAccount& account = diagnosis.angle.emplace();
    account.walk_deg = angle.number("walk_deg");
    account.validation_start_deg = angle.number_if_any("validation_start_deg");
    angle.finish();
}

}  // namespace ripplenotch
