// SPDX-License-Identifier: MIT
#include <fmt/ranges.h>

#include <map>

#include "document/fields/fields.hpp"
#include "document/json/json.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/visible_text.hpp"
#include "ripplenotch/document/trend_json.hpp"
#include "ripplenotch/fleet/features.hpp"

namespace ripplenotch {

namespace {

constexpr std::size_t most_rows = 200000;  // of a table: joints times months

using JointName = std::pair<std::string, std::string>;

class TrendReader {
  public:
    explicit TrendReader(Fields& fields) : fields_(fields) {}

    [[nodiscard]] Trend read() {
        trend_.joint_months = fields_.number("joint_months");
        fields_.each(
            "joints", [&](Fields& row) { joint(row); }, most_rows);
        fields_.each(
            "months", [&](Fields& row) { month(row); }, most_rows);
        fields_.each(
            "alerts", [&](Fields& row) { alert(row); }, most_rows);
        fields_.each(
            "courses", [&](Fields& row) { course(row); }, most_rows);
        return std::move(trend_);
    }

  private:
    static JointName name_of(Fields& row) { return {row.text("robot"), row.text("joint")}; }
    static std::string date_of(Fields& row, std::string_view name) {
        std::string date = row.text(name);
        if (!date_seconds(date))
            raise<DataError>("{} is '{}', expected a date such as 2026-01-05T12:30:00Z", row.where(name),
                             date);
        return date;
    }
    JointTrend& joint_of(Fields& row) {
        const auto found = places_.find(name_of(row));
        if (found == places_.end())
            raise<DataError>("{} is '{}', which is none of the joints", row.where("joint"),
                             row.text("joint"));
        return trend_.joints[found->second];
    }

    void joint(Fields& row) {
        JointTrend& one = trend_.joints.emplace_back();
        std::tie(one.robot, one.joint) = name_of(row);
        places_[{one.robot, one.joint}] = trend_.joints.size() - 1;
        one.from = row.text("from");
        row.ignore({"alerts", "lines", "to", "months", "conditions", "notes"});
    }
    void month(Fields& row) {
        JointMonth one{row.text("month"), row.text("descriptor"), row.number("deviations")};
        joint_of(row).course.push_back(std::move(one));
    }
    void alert(Fields& row) {
        JointChange one;
        one.cause = row.text("cause");
        one.drift = row.text("kind") == "drift";
        one.date = date_of(row, "date");
        one.earliest = date_of(row, "earliest");
        one.latest = date_of(row, "latest");
        if (row.has("descriptor")) one.descriptors.push_back({row.text("descriptor"), 0.0, {}, {}});
        row.ignore({"p", "limit", "kin", "size", "size_ci95_low", "size_ci95_high", "percent",
                    "last_log_before", "last_page_before", "first_log_after", "first_page_after"});
        joint_of(row).changes.push_back(std::move(one));
    }
    void course(Fields& row) {
        const std::string alert = row.text("alert"), descriptor = row.text("descriptor");
        AdjustedValue value{date_of(row, "date"), row.number("value"), row.text("log"), {}};
        row.ignore({"page"});
        for (JointChange& one : joint_of(row).changes)
            if (one.date == alert && !one.descriptors.empty() && one.descriptors.front().name == descriptor)
                return one.course.push_back(std::move(value));
        raise<DataError>("{} is '{}', which is the date of no alert of this joint", row.where("alert"),
                         alert);
    }

    Fields& fields_;
    Trend trend_;
    std::map<JointName, std::size_t> places_;
};

}  // namespace

Trend trend_from_json(std::string_view text, const std::string& source) {
    const Json json = parse_document(text, source, "trend");
    Fields fields(json, source, "");
    return TrendReader(fields).read();
}

namespace {

Json head_of(const JointTrend& joint) { return {{"robot", joint.robot}, {"joint", joint.joint}}; }

Json page_or_null(const std::string& page) { return page.empty() ? Json(nullptr) : Json(page); }

void add_interval(Json& json, const std::string& name, const Interval& interval) {
    json[name + "_ci95_low"] = six_digits(interval.low);
    json[name + "_ci95_high"] = six_digits(interval.high);
}

Json alert_to_json(const JointTrend& joint, const JointChange& change) {
    Json json = head_of(joint);
    json["cause"] = change.cause;
    json["kind"] = change.drift ? "drift" : "step";
    json["date"] = change.date;
    json["earliest"] = change.earliest;
    json["latest"] = change.latest;
    json["p"] = six_digits(change.p);
    json["limit"] = six_digits(change.limit);
    json["kin"] = change.kin;
    if (!change.descriptors.empty()) {
        const ChangedDescriptor& surest = change.descriptors.front();
        json["descriptor"] = surest.name;
        json["size"] = six_digits(surest.size);
        add_interval(json, "size", surest.ci95);
        json["percent"] = six_digits(surest.percent);
    }
    json["last_log_before"] = change.last_log;
    json["last_page_before"] = page_or_null(change.last_page);
    json["first_log_after"] = change.first_log;
    json["first_page_after"] = page_or_null(change.first_page);
    return json;
}

Json part_to_json(const JointTrend& joint, const JointChange& change, const ChangedDescriptor& part) {
    Json json = head_of(joint);
    json["date"] = change.date;
    json["descriptor"] = part.name;
    json["size"] = six_digits(part.size);
    add_interval(json, "size", part.ci95);
    json["percent"] = six_digits(part.percent);
    return json;
}

Json descriptor_to_json(const JointTrend& joint, const DescriptorTrend& one) {
    Json json = head_of(joint);
    json["descriptor"] = one.name;
    json["lines"] = one.lines;
    json["baseline"] = six_digits(one.baseline);
    json["slope_per_month"] = six_digits(one.slope_per_month);
    json["slope_ci95_low"] = one.slope_ci95 ? six_digits(one.slope_ci95->low) : Json(nullptr);
    json["slope_ci95_high"] = one.slope_ci95 ? six_digits(one.slope_ci95->high) : Json(nullptr);
    json["spread"] = one.baseline ? six_digits(one.spread) : Json(nullptr);
    json["reason"] = one.reason;
    return json;
}

Json joint_to_json(const JointTrend& joint) {
    Json json = head_of(joint);
    json["alerts"] = joint.changes.size();
    json["lines"] = joint.lines;
    json["from"] = joint.from;
    json["to"] = joint.to;
    json["months"] = six_digits(joint.months);
    json["conditions"] = fmt::format("{}", fmt::join(joint.conditions, ", "));
    json["notes"] = fmt::format("{}", fmt::join(joint.notes, "; "));
    return json;
}

// Of the worst alerts, which are those of the joints that stand first.
void add_courses(const Trend& trend, Json& json) {
    std::size_t shown = 0;
    for (const JointTrend& joint : trend.joints) {
        for (const JointChange& change : joint.changes) {
            if (change.course.empty() || shown++ >= most_trend_courses) continue;
            for (const AdjustedValue& value : change.course) {
                Json one = head_of(joint);
                one["alert"] = change.date;
                one["descriptor"] = change.descriptors.front().name;
                one["date"] = value.date;
                one["value"] = six_digits(value.value);
                one["log"] = value.log;
                one["page"] = page_or_null(value.page);
                json["courses"].push_back(std::move(one));
            }
        }
    }
}

void add_lists(const Trend& trend, Json& json) {
    for (const char* name : {"alerts", "courses", "changed", "odd", "joints", "descriptors", "months"})
        json[name] = Json::array();
    for (const JointTrend& joint : trend.joints) {
        for (const JointChange& change : joint.changes) {
            json["alerts"].push_back(alert_to_json(joint, change));
            for (const ChangedDescriptor& part : change.descriptors)
                json["changed"].push_back(part_to_json(joint, change, part));
        }
        for (const OddDescriptor& one : joint.odd) {
            Json odd = head_of(joint);
            odd["descriptor"] = one.name;
            odd["baseline"] = six_digits(one.baseline);
            odd["median_of_kind"] = six_digits(one.of_kind);
            odd["deviations"] = six_digits(one.deviations);
            json["odd"].push_back(std::move(odd));
        }
        json["joints"].push_back(joint_to_json(joint));
        for (const DescriptorTrend& one : joint.descriptors)
            json["descriptors"].push_back(descriptor_to_json(joint, one));
        for (const JointMonth& month : joint.course) {
            Json one = head_of(joint);
            one["month"] = month.month;
            one["deviations"] = six_digits(month.deviations);
            one["descriptor"] = month.descriptor;
            json["months"].push_back(std::move(one));
        }
    }
}

}  // namespace

std::string trend_verdict(const Trend& trend) {
    std::size_t changed = 0, looked_at = 0;
    for (const JointTrend& joint : trend.joints) {
        changed += joint.changes.empty() ? 0 : 1;
        looked_at += joint.course.empty() ? 0 : 1;
    }
    const std::string chance =
        fmt::format("chance alone would give {:.2g} alerts at most in {:.4g} joint-months",
                    trend.expected_false_alarms, trend.joint_months);
    if (looked_at == 0) return "No joint has enough logs of different days to look for changes.";
    if (changed == 0) return fmt::format("None of {} joints changed; {}.", looked_at, chance);
    const JointTrend& first = trend.joints.front();
    const std::string worst =
        first.changes.empty() ? "" : fmt::format(", first {}: {}", first.name(), first.changes.front().cause);
    return fmt::format("{} of {} joints changed{}; {}.", changed, looked_at, worst, chance);
}

std::string trend_text(const Trend& trend, const Provenance& provenance) {
    Json json = document_head("trend", provenance);
    json["verdict"] = trend_verdict(trend);
    json["false_alarms_per_joint_month"] = trend.options.false_alarms;
    json["expected_false_alarms"] = six_digits(trend.expected_false_alarms);
    json["joint_months"] = six_digits(trend.joint_months);
    json["seed"] = trend.options.seed;
    json["lines"] = trend.lines;
    json["failed_lines"] = trend.failed;
    json["notes"] = trend.notes;
    add_lists(trend, json);
    add_courses(trend, json);
    return to_text(json);
}

std::string alert_lines(const Trend& trend) {
    std::string text;
    for (const JointTrend& joint : trend.joints)
        for (const JointChange& change : joint.changes)
            text += visible_json(
                        alert_to_json(joint, change).dump(-1, ' ', false, Json::error_handler_t::replace)) +
                    "\n";
    return text;
}

}  // namespace ripplenotch
