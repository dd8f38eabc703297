// SPDX-License-Identifier: MIT
#include "ripplenotch/document/trend_json.hpp"

#include <fmt/ranges.h>

#include <map>
#include <utility>

#include "document/fields/fields.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/fleet/features.hpp"

namespace ripplenotch {

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
            if (change.course.empty() || shown++ >= most_trend_courses) continue;
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
