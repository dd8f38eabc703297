// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>

#include "document/fields/fields.hpp"
#include "document/fields/result_fields.hpp"
#include "document/json/json.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/visible_text.hpp"
#include "ripplenotch/document/features_json.hpp"
#include "ripplenotch/fleet/features.hpp"

namespace ripplenotch {

namespace {

constexpr std::string_view features_line = "a line of features, as 'ripplenotch features' prints it";

class LineFields {
  public:
    LineFields(const Json& json, const std::string& source) : json_(json), source_(source) {}

    [[noreturn]] void refuse(std::string_view name, std::string_view expected) const {
        const auto found = json_.find(name);
        raise<DataError>("{}: {} is {}, expected {}", source_, name,
                         found == json_.end() ? "not there" : in_words(*found), expected);
    }
    [[nodiscard]] std::string text(std::string_view name) const {
        const auto found = json_.find(name);
        if (found == json_.end() || !found->is_string()) refuse(name, "a text");
        return found->get<std::string>();
    }
    [[nodiscard]] std::optional<double> number_or_null(std::string_view name) const {
        const auto found = json_.find(name);
        if (found == json_.end() || !(found->is_number() || found->is_null()))
            refuse(name, "a number or null");
        return found->is_null() ? std::nullopt : std::optional(found->get<double>());
    }
    [[nodiscard]] double number(std::string_view name) const {
        const auto value = number_or_null(name);
        if (!value) refuse(name, "a number");
        return *value;
    }
    [[nodiscard]] std::size_t whole(std::string_view name) const {
        const double value = number(name);
        if (value < 0.0 || value > 1e15 || value != std::floor(value)) refuse(name, "a whole number");
        return static_cast<std::size_t>(value);
    }
    [[nodiscard]] std::string reason(const std::string& name) const {
        const auto reasons = json_.find("not_told");
        if (reasons == json_.end() || !reasons->is_object()) refuse("not_told", "an object of reasons");
        const auto found = reasons->find(name);
        if (found == reasons->end() || !found->is_string() || found->get<std::string>().empty())
            raise<DataError>("{}: {} is null and not_told has no reason for it", source_, name);
        return found->get<std::string>();
    }
    [[nodiscard]] std::optional<Interval> interval(const std::string& name) const {
        const auto found = json_.find(name);
        if (found == json_.end()) return std::nullopt;
        const bool two = found->is_array() && found->size() == 2 && (*found)[0].is_number() &&
                         (*found)[1].is_number() && (*found)[0].get<double>() <= (*found)[1].get<double>();
        if (!two) refuse(name, "two numbers, the lower one first");
        return Interval{(*found)[0].get<double>(), (*found)[1].get<double>()};
    }
    [[nodiscard]] const Json& json() const { return json_; }

  private:
    const Json& json_;
    const std::string& source_;
};

bool is_known(std::string_view name) {
    constexpr std::array names = {
        "schema",    "version",     "log",        "sha256",           "robot",
        "joint",     "error",       "date",       "error_code",       "date_source",
        "rows",      "load_rms_nm", "duration_s", "temperature_degc", "temperature_source",
        "reversals", "not_told"};
    return std::find(names.begin(), names.end(), name) != names.end() ||
           std::any_of(mix_fields.begin(), mix_fields.end(),
                       [&](const MixField& field) { return field.name == name; });
}

void read_descriptors(const LineFields& line, const std::string& source, FeatureLine& read) {
    std::size_t intervals = 0;
    for (const auto& [name, value] : line.json().items()) {
        if (is_known(name)) continue;
        if (name.find("_ci95") != std::string::npos) {
            ++intervals;
            continue;
        }
        try {
            read.descriptors.push_back(descriptor_named(name));
        } catch (const DataError& error) {
            raise<DataError>("{}: {}", source, error.what());
        }
        Descriptor& one = read.descriptors.back();
        one.value = line.number_or_null(name);
        if (one.value) one.ci95 = line.interval(one.interval_name());
        if (one.ci95) --intervals;
        if (!one.value) one.reason = line.reason(name);
    }
    if (intervals != 0) raise<DataError>("{}: an interval stands beside no value", source);
}

void read_conditions(const LineFields& line, FeatureLine& read) {
    const auto date = line.json().find("date");
    if (date == line.json().end() || !(date->is_null() || date->is_string()))
        line.refuse("date", "a date or null");
    if (date->is_string()) {
        read.date = date->get<std::string>();
        if (!date_seconds(*read.date)) line.refuse("date", "a date such as 2026-01-05T12:30:00Z");
    }
    read.date_source = read.date ? line.text("date_source") : line.reason("date");
    read.temperature_degc = line.number_or_null("temperature_degc");
    read.temperature_source =
        read.temperature_degc ? line.text("temperature_source") : line.reason("temperature_degc");
    read.rows = line.whole("rows");
    read.duration_s = line.number("duration_s");
    for (const MixField& field : mix_fields) read.mix.*field.value = line.number(field.name);
    read.mix.reversals = line.whole("reversals");
    read.mix.load_rms_nm = line.number_or_null("load_rms_nm");
}

}  // namespace

FeatureLine feature_line_from_json(std::string_view text, const std::string& source) {
    const Json json = read_json(text, source, features_line);
    if (!json.is_object()) raise<DataError>("{}: expected {}", source, features_line);
    const LineFields line(json, source);
    if (line.text("schema") != features_schema) line.refuse("schema", features_schema);
    FeatureLine read;
    read.version = line.text("version");
    read.log = line.text("log");
    read.sha256 = line.text("sha256");
    read.robot = line.text("robot");
    read.joint = line.text("joint");
    if (json.contains("error")) {
        read.error = line.text("error");
        read.error_code = static_cast<int>(line.whole("error_code"));
        if (read.error.empty()) line.refuse("error", "a message");
        return read;
    }
    read_conditions(line, read);
    read_descriptors(line, source, read);
    return read;
}

std::vector<FeatureLine> feature_lines_from_text(std::string_view text, const std::string& source) {
    std::vector<FeatureLine> lines;
    for (std::size_t at = 0, number = 1; at < text.size(); ++number) {
        const std::size_t end = std::min(text.find('\n', at), text.size());
        const std::string_view one = text.substr(at, end - at);
        if (one.find_first_not_of(" \t\r") != std::string_view::npos)
            lines.push_back(feature_line_from_json(one, fmt::format("{}, line {}", source, number)));
        at = end + 1;
    }
    return lines;
}

std::string shard_record_text(const ShardRecord& record) {
    Json json;
    json["schema"] = "ripplenotch/shard/1";
    json["version"] = record.version;
    json["settings"] = record.settings;
    json["manifest_sha256"] = record.manifest_sha256;
    json["shard"] = record.shard.number;
    json["shards"] = record.shard.of;
    json["logs"] = record.logs;
    json["lines"] = record.lines;
    json["failed"] = record.failed;
    json["sha256"] = record.sha256;
    return to_text(json);
}

ShardRecord shard_record_from_json(std::string_view text, const std::string& source) {
    const Json json = parse_document(text, source, "shard");
    Fields fields(json, source, "");
    fields.ignore({"schema"});
    ShardRecord record;
    record.version = fields.text("version");
    record.settings = fields.text("settings");
    record.manifest_sha256 = fields.text("manifest_sha256");
    record.shard = {fields.whole("shard"), fields.whole("shards")};
    if (record.shard.number < 1 || record.shard.number > record.shard.of || record.shard.of > most_shards)
        raise<DataError>("{} is {}, expected 1 to {}", fields.where("shard"), record.shard.number,
                         record.shard.of);
    record.logs = fields.whole("logs");
    record.lines = fields.whole("lines");
    record.failed = fields.whole("failed");
    record.sha256 = fields.text("sha256");
    fields.finish();
    return record;
}

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
