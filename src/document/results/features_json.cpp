// SPDX-License-Identifier: MIT
#include "ripplenotch/document/results.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <utility>

#include "document/fields/fields.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/visible_text.hpp"
#include "ripplenotch/fleet/features.hpp"
#include "ripplenotch/fleet/trend.hpp"

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

void describe(JsonWriter& json, const ChangedDescriptor& changed) {
    json("descriptor", changed.name);
    json("size", changed.size, six);
    json("size_ci95_low", changed.ci95.low, six);
    json("size_ci95_high", changed.ci95.high, six);
    json("percent", changed.percent, six);
}

void describe(JsonWriter& json, const DescriptorTrend& one) {
    json("descriptor", one.name);
    json("lines", one.lines);
    json("baseline", one.baseline, six);
    json("slope_per_month", one.slope_per_month, six);
    const Interval slope = one.slope_ci95.value_or(Interval{});
    json.known("slope_ci95_low", one.slope_ci95.has_value(), slope.low, six);
    json.known("slope_ci95_high", one.slope_ci95.has_value(), slope.high, six);
    json.known("spread", one.baseline.has_value(), one.spread, six);
    json("reason", one.reason);
}

void describe(JsonWriter& json, const JointChange& change) {
    json("kind", change.drift ? "drift" : "step");
    json("date", change.date);
    json("p", change.p, six);
    json("limit", change.limit, six);
    if (!change.descriptors.empty()) describe(json, change.descriptors.front());
    json("last_log_before", change.last_log);
    json("first_log_after", change.first_log);
}

void describe(JsonWriter& json, const JointTrend& joint) {
    json("alerts", joint.changes.size());
    json("lines", joint.lines);
    json("from", joint.from);
    json("to", joint.to);
    json("months", joint.months, six);
    json("conditions", fmt::format("{}", fmt::join(joint.conditions, ", ")));
    json("notes", fmt::format("{}", fmt::join(joint.notes, "; ")));
}

namespace {

// A row for each joint, or for each part of it: trend.json is flat, since a page shows it so.
// `parts_of` calls add(describe_part) for each part of a joint.
template <class PartsOf>
void add_rows(JsonWriter& json, std::string_view name, const Trend& trend, const PartsOf& parts_of) {
    Json rows = Json::array();
    for (const JointTrend& joint : trend.joints)
        parts_of(joint, [&](const auto& describe_part) {
            rows.push_back(JsonWriter::object_of([&](JsonWriter& row) {
                row("robot", joint.robot);
                row("joint", joint.joint);
                describe_part(row);
            }));
        });
    json.put(name, std::move(rows));
}

// The same of a list that a joint has.
template <class Part>
auto each_of(std::vector<Part> JointTrend::*parts) {
    return [parts](const JointTrend& joint, const auto& add) {
        for (const Part& part : joint.*parts) add([&](JsonWriter& row) { describe(row, part); });
    };
}

}  // namespace

void describe(JsonWriter& json, const Trend& trend) {
    json("verdict", trend_verdict(trend));
    json("false_alarms_per_joint_month", false_alarms_per_joint_month);
    json("expected_false_alarms", trend.expected_false_alarms, six);
    json("joint_months", trend.joint_months, six);
    json("seed", trend.seed);
    json("lines", trend.lines);
    json("failed_lines", trend.failed);
    json("notes", trend.notes);
    add_rows(json, "alerts", trend, each_of(&JointTrend::changes));
    std::size_t shown = 0;
    add_rows(json, "courses", trend, [&shown](const JointTrend& joint, const auto& add) {
        for (const JointChange& change : joint.changes) {
            if (change.course.empty() || shown++ >= max_trend_courses) continue;
            for (const AdjustedValue& value : change.course)
                add([&](JsonWriter& row) {
                    row("alert", change.date);
                    row("descriptor", change.descriptors.front().name);
                    row("date", value.date);
                    row("value", value.value, six);
                    row("log", value.log);
                });
        }
    });
    add_rows(json, "changed", trend, [](const JointTrend& joint, const auto& add) {
        for (const JointChange& change : joint.changes)
            for (const ChangedDescriptor& part : change.descriptors)
                add([&](JsonWriter& row) {
                    row("date", change.date);
                    describe(row, part);
                });
    });
    add_rows(json, "joints", trend, [](const JointTrend& joint, const auto& add) {
        add([&](JsonWriter& row) { describe(row, joint); });
    });
    add_rows(json, "descriptors", trend, each_of(&JointTrend::descriptors));
}

std::string trend_verdict(const Trend& trend) {
    std::size_t changed = 0, looked_at = 0;
    for (const JointTrend& joint : trend.joints) {
        changed += joint.changes.empty() ? 0 : 1;
        looked_at += joint.looked_at() ? 1 : 0;
    }
    const std::string chance =
        fmt::format("chance alone would give {:.2g} alerts at most in {:.4g} joint-months",
                    trend.expected_false_alarms, trend.joint_months);
    if (looked_at == 0) return "No joint has enough logs of different days to look for changes.";
    if (changed == 0) return fmt::format("None of {} joints changed; {}.", looked_at, chance);
    const JointTrend& first = trend.joints.front();
    const std::string worst =
        first.changes.empty() || first.changes.front().descriptors.empty()
            ? ""
            : fmt::format(", first {}: {}", first.name(), first.changes.front().descriptors.front().name);
    return fmt::format("{} of {} joints changed{}; {}.", changed, looked_at, worst, chance);
}

std::string trend_text(const Trend& trend, const Provenance& provenance) {
    return to_text(document_of("trend", provenance, trend));
}

}  // namespace ripplenotch
