// SPDX-License-Identifier: MIT
#include "cli/trend/trend_report.hpp"

#include <fmt/format.h>

#include "cli/text_table.hpp"
#include "ripplenotch/document/trend_json.hpp"

namespace ripplenotch {
namespace {

constexpr std::size_t most_odd = 20, most_notes = 20;
using TrendRows = std::vector<std::vector<std::string>>;

std::string day_of(const std::string& date) { return date.substr(0, 10); }

std::string days_of(const JointChange& change) {
    if (change.drift) return "all the time";
    if (change.earliest == change.latest) return day_of(change.date);
    return fmt::format("{} ({} to {})", day_of(change.date), day_of(change.earliest), day_of(change.latest));
}

std::string size_of(const ChangedDescriptor& one) {
    const double half = 0.5 * (one.ci95.high - one.ci95.low);
    std::string text = fmt::format("{} {:+.3g} +/- {:.2g}", one.name, one.size, half);
    if (one.percent) text += fmt::format(" ({:+.1f} %)", *one.percent);
    return text;
}

TrendRows alerts_of(const Trend& trend) {
    TrendRows rows = {{"joint", "alert", "since", "surest sign, 95 %", "p", ""}};
    for (const JointTrend& joint : trend.joints) {
        for (const JointChange& change : joint.changes) {
            rows.push_back({joint.name(), (change.drift ? "drift: " : "") + change.cause, days_of(change),
                            change.descriptors.empty() ? "" : size_of(change.descriptors.front()),
                            fmt::format("{:.1g}", change.p),
                            change.kin == 0 ? "" : fmt::format("so did {} of its kind", change.kin)});
        }
    }
    return rows;
}

TrendRows odd_of(const Trend& trend) {
    TrendRows rows = {{"joint", "descriptor", "baseline", "its kind", "deviations"}};
    for (const JointTrend& joint : trend.joints)
        for (const OddDescriptor& one : joint.odd)
            if (rows.size() <= most_odd)
                rows.push_back({joint.name(), one.name, fmt::format("{:.4g}", one.baseline),
                                fmt::format("{:.4g}", one.of_kind), fmt::format("{:+.1f}", one.deviations)});
    return rows;
}

std::string notes_of(const Trend& trend) {
    std::vector<std::string> notes = trend.notes;
    for (const JointTrend& joint : trend.joints)
        for (const std::string& note : joint.notes)
            notes.push_back((joint.name().empty() ? "the joint" : joint.name()) + ": " + note);
    std::string text;
    for (std::size_t i = 0; i < notes.size() && i < most_notes; ++i) text += "\n" + notes[i];
    if (notes.size() > most_notes)
        text += fmt::format("\nand {} more notes in --json", notes.size() - most_notes);
    return text.empty() ? text : text + "\n";
}

}  // namespace

std::string trend_report(const Trend& trend) {
    std::string text = trend_verdict(trend) + "\n";
    const TrendRows alerts = alerts_of(trend), odd = odd_of(trend);
    if (alerts.size() > 1) text += "\n" + text_table(alerts, "llllrl");
    if (odd.size() > 1) text += "\nunlike the others of their kind\n" + text_table(odd, "llrrr");
    return text + notes_of(trend);
}

}  // namespace ripplenotch
