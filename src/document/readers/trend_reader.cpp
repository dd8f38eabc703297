// SPDX-License-Identifier: MIT
#include <map>

#include "document/fields/document_head.hpp"
#include "document/fields/fields.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/document/trend_json.hpp"
#include "ripplenotch/fleet/log_date.hpp"

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

}  // namespace ripplenotch
