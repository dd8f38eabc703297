// SPDX-License-Identifier: MIT
#include "ripplenotch/document/features_json.hpp"

#include <algorithm>

#include "document/fields/fields.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/visible_text.hpp"
#include "ripplenotch/fleet/features.hpp"

namespace ripplenotch {

namespace {

constexpr std::string_view features_schema = "ripplenotch/features/1";
constexpr std::string_view features_line = "a line of features, as 'ripplenotch features' prints it";

// Why a field is null.
std::string reason_of(JsonReader& line, const std::string& name) {
    const Json& reasons = line.at("not_told");
    const auto found = reasons.find(name);
    if (found == reasons.end() || !found->is_string() || found->get<std::string>().empty())
        raise<DataError>("{} is null and not_told has no reason for it", line.where(name));
    return found->get<std::string>();
}

// The source of a condition, or the reason why it is unknown.
template <class Archive>
void describe_source(Archive& archive, const std::string& name, bool is_told, auto& source) {
    const std::string field = name.substr(0, name.find('_')) + "_source";
    if constexpr (Archive::reading) {
        archive.ignore({field});
        source = is_told ? archive.text(field) : reason_of(archive, name);
    } else {
        archive(field, is_told ? source : std::string());
    }
}

// Whatever else stands in the line is a descriptor, or the interval of one.
void read_descriptors(JsonReader& line, FeatureLine& read) {
    for (const std::string& name : line.not_asked_for()) {
        if (name.find("_ci95") != std::string::npos) continue;
        try {
            read.descriptors.push_back(descriptor_named(name));
        } catch (const DataError& error) {
            raise<DataError>("{}: {}", line.source(), error.what());
        }
        Descriptor& one = read.descriptors.back();
        line(name, one.value);
        if (one.value)
            line(one.interval_name(), one.ci95, lower_first);
        else
            one.reason = reason_of(line, name);
    }
}

void write_descriptors(JsonWriter& json, const FeatureLine& line) {
    for (const Descriptor& one : line.descriptors) {
        json(one.name(), one.value, six);
        if (one.value) json(one.interval_name(), one.ci95, if_any, six);
    }
    json.group("not_told", [&](JsonWriter& reasons) {
        for (const Descriptor& one : line.descriptors)
            if (!one.value) reasons(one.name(), one.reason);
        if (!line.date) reasons("date", line.date_source);
        if (!line.temperature_degc) reasons("temperature_degc", line.temperature_source);
        if (!line.mix.load_rms_nm)
            reasons("load_rms_nm", "the joint has neither inertia nor weight in this log");
    });
}

}  // namespace

template <class Archive>
void describe(Archive& archive, Is<FeatureLine> auto& line) {
    std::string schema(features_schema);
    archive("schema", schema);
    if constexpr (Archive::reading) {
        if (schema != features_schema)
            raise<DataError>("{} is \"{}\", expected {}", archive.where("schema"), schema, features_schema);
    }
    archive("version", line.version);
    archive("log", line.log);
    archive("sha256", line.sha256);
    archive("robot", line.robot);
    archive("joint", line.joint);
    if (archive.holds("error", line.failed())) {
        archive("error", line.error);
        archive("error_code", line.error_code);
        return;
    }
    archive("date", line.date);
    if constexpr (Archive::reading) {
        archive.ignore({"not_told"});
        if (line.date && !date_seconds(*line.date))
            raise<DataError>("{} is \"{}\", expected a date such as 2026-01-05T12:30:00Z",
                             archive.where("date"), *line.date);
    }
    describe_source(archive, "date", line.date.has_value(), line.date_source);
    archive("temperature_degc", line.temperature_degc, six);
    describe_source(archive, "temperature_degc", line.temperature_degc.has_value(), line.temperature_source);
    archive("rows", line.rows);
    archive("duration_s", line.duration_s, six);
    archive("moving_share", line.mix.moving_share, six);
    archive("forward_share", line.mix.forward_share, six);
    archive("speed_p10_deg_s", line.mix.speed_p10_deg_s, six);
    archive("speed_p50_deg_s", line.mix.speed_p50_deg_s, six);
    archive("speed_p90_deg_s", line.mix.speed_p90_deg_s, six);
    archive("travel_deg", line.mix.travel_deg, six);
    archive("torque_rms_nm", line.mix.torque_rms_nm, six);
    archive("reversals", line.mix.reversals);
    archive("load_rms_nm", line.mix.load_rms_nm, six);
    if constexpr (Archive::reading)
        read_descriptors(archive, line);
    else
        write_descriptors(archive, line);
}

FeatureLine feature_line_from_json(std::string_view text, const std::string& source) {
    const Json json = read_json(text, source, features_line);
    if (!json.is_object()) raise<DataError>("{}: expected {}", source, features_line);
    FeatureLine line;
    JsonReader reader(json, source, "");
    describe(reader, line);
    reader.finish();
    return line;
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

std::string feature_line_text(const FeatureLine& line) {
    return visible_json(to_json(line).dump(-1, ' ', false, Json::error_handler_t::replace)) + "\n";
}

}  // namespace ripplenotch
