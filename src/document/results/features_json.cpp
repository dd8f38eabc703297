// SPDX-License-Identifier: MIT
#include "ripplenotch/document/features_json.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <utility>

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

namespace {

constexpr AtMost most_rows{200000};

// What belongs to a joint as a row of a table: trend.json is flat, since a page shows it so.
template <class Part>
struct Row {
    std::string robot, joint;
    Part part;
};

template <class Value>
concept IsRow = requires(Value& value) {
    value.part;
    value.robot;
};

// A value in the course of an alert, which its date and descriptor name.
struct CourseValue {
    std::string alert, descriptor;
    AdjustedValue value;
};

// A descriptor that took part in an alert of this date.
struct DatedDescriptor {
    std::string date;
    ChangedDescriptor changed;
};

template <class Part>
std::vector<Row<Part>> rows_of(const Trend& trend, std::vector<Part> JointTrend::*parts) {
    std::vector<Row<Part>> rows;
    for (const JointTrend& joint : trend.joints)
        for (const Part& part : joint.*parts) rows.push_back({joint.robot, joint.joint, part});
    return rows;
}

// Of the worst alerts, which are those of the joints that stand first.
std::vector<Row<CourseValue>> course_rows(const Trend& trend) {
    std::vector<Row<CourseValue>> rows;
    std::size_t shown = 0;
    for (const JointTrend& joint : trend.joints)
        for (const JointChange& change : joint.changes) {
            if (change.course.empty() || shown++ >= max_trend_courses) continue;
            for (const AdjustedValue& value : change.course)
                rows.push_back(
                    {joint.robot, joint.joint, {change.date, change.descriptors.front().name, value}});
        }
    return rows;
}

std::vector<Row<DatedDescriptor>> changed_rows(const Trend& trend) {
    std::vector<Row<DatedDescriptor>> rows;
    for (const JointTrend& joint : trend.joints)
        for (const JointChange& change : joint.changes)
            for (const ChangedDescriptor& part : change.descriptors)
                rows.push_back({joint.robot, joint.joint, {change.date, part}});
    return rows;
}

template <class Archive>
void describe_date(Archive& archive, std::string_view name, auto& date) {
    archive(name, date);
    if constexpr (Archive::reading) {
        if (!date_seconds(date))
            raise<DataError>("{} is '{}', expected a date such as 2026-01-05T12:30:00Z", archive.where(name),
                             date);
    }
}

}  // namespace

void describe(JsonWriter& json, const ChangedDescriptor& changed) {
    json("descriptor", changed.name);
    json("size", changed.size, six);
    json("size_ci95_low", changed.ci95.low, six);
    json("size_ci95_high", changed.ci95.high, six);
    json("percent", changed.percent, six);
}

void describe(JsonWriter& json, const DatedDescriptor& one) {
    json("date", one.date);
    describe(json, one.changed);
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

// A picture needs no more of an alert than is read of it.
template <class Archive>
void describe(Archive& archive, Is<JointChange> auto& change) {
    std::string kind = change.drift ? "drift" : "step";
    archive("kind", kind);
    describe_date(archive, "date", change.date);
    if constexpr (Archive::reading) {
        change.drift = kind == "drift";
        if (archive.has("descriptor"))
            change.descriptors.push_back({archive.text("descriptor"), 0.0, {}, {}});
        archive.ignore({"p", "limit", "size", "size_ci95_low", "size_ci95_high", "percent", "last_log_before",
                        "first_log_after"});
    } else {
        archive("p", change.p, six);
        archive("limit", change.limit, six);
        if (!change.descriptors.empty()) describe(archive, change.descriptors.front());
        archive("last_log_before", change.last_log);
        archive("first_log_after", change.first_log);
    }
}

void describe(auto& archive, Is<CourseValue> auto& one) {
    archive("alert", one.alert);
    archive("descriptor", one.descriptor);
    describe_date(archive, "date", one.value.date);
    archive("value", one.value.value, six);
    archive("log", one.value.log);
}

void describe(auto& archive, IsRow auto& row) {
    archive("robot", row.robot);
    archive("joint", row.joint);
    describe(archive, row.part);
}

void describe(auto& archive, Is<JointTrend> auto& joint) {
    archive("robot", joint.robot);
    archive("joint", joint.joint);
    archive.derived("alerts", [&] { return joint.changes.size(); });
    archive.derived("lines", [&] { return joint.lines; });
    archive("from", joint.from);
    archive.derived("to", [&] { return joint.to; });
    archive.derived(
        "months", [&] { return joint.months; }, six);
    archive.derived("conditions", [&] { return fmt::format("{}", fmt::join(joint.conditions, ", ")); });
    archive.derived("notes", [&] { return fmt::format("{}", fmt::join(joint.notes, "; ")); });
}

namespace {

using JointsByName = std::map<std::pair<std::string, std::string>, JointTrend*>;

JointTrend& joint_of(const JsonReader& reader, std::string_view table, const JointsByName& joints,
                     const auto& row) {
    const auto found = joints.find({row.robot, row.joint});
    if (found == joints.end())
        raise<DataError>("{}: joint is '{}', which is none of the joints", reader.where(table), row.joint);
    return *found->second;
}

void add_course(const JsonReader& reader, JointTrend& joint, CourseValue one) {
    for (JointChange& change : joint.changes)
        if (change.date == one.alert && !change.descriptors.empty() &&
            change.descriptors.front().name == one.descriptor)
            return change.course.push_back(std::move(one.value));
    raise<DataError>("{}: alert is '{}', which is the date of no alert of this joint",
                     reader.where("courses"), one.alert);
}

}  // namespace

template <class Archive>
void describe(Archive& archive, Is<Trend> auto& trend) {
    std::vector<Row<JointChange>> alerts;
    std::vector<Row<CourseValue>> courses;
    if constexpr (!Archive::reading) {
        alerts = rows_of(trend, &JointTrend::changes);
        courses = course_rows(trend);
    }
    archive.derived("verdict", [&] { return trend_verdict(trend); });
    archive.derived("false_alarms_per_joint_month", [] { return false_alarms_per_joint_month; });
    archive.derived(
        "expected_false_alarms", [&] { return trend.expected_false_alarms; }, six);
    archive("joint_months", trend.joint_months, six);
    archive.derived("seed", [&] { return trend.seed; });
    archive.derived("lines", [&] { return trend.lines; });
    archive.derived("failed_lines", [&] { return trend.failed; });
    archive.derived("notes", [&] { return trend.notes; });
    archive("alerts", alerts, most_rows);
    archive("courses", courses, most_rows);
    archive.derived("changed", [&] { return changed_rows(trend); });
    archive("joints", trend.joints, most_rows);
    archive.derived("descriptors", [&] { return rows_of(trend, &JointTrend::descriptors); });
    if constexpr (Archive::reading) {
        JointsByName joints;
        for (JointTrend& joint : trend.joints) joints[{joint.robot, joint.joint}] = &joint;
        for (auto& row : alerts) joint_of(archive, "alerts", joints, row).changes.push_back(row.part);
        for (auto& row : courses) add_course(archive, joint_of(archive, "courses", joints, row), row.part);
    }
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

Trend trend_from_json(std::string_view text, const std::string& source) {
    return result_of<Trend>(text, source, "trend");
}

}  // namespace ripplenotch
