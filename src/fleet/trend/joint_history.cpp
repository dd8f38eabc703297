// SPDX-License-Identifier: MIT
#include "fleet/trend/joint_history.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <span>
#include <string>
#include <tuple>
#include <vector>

#include "core/matrices/least_squares.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/portable_math.hpp"
#include "ripplenotch/fleet/features.hpp"

namespace ripplenotch {

namespace {

void require_one_version(std::span<const FeatureLine> lines) {
    for (const FeatureLine& line : lines)
        if (line.version != lines.front().version)
            raise<DataError>(
                "lines of two versions of the tool: {} has {}, {} has {}; make them all by one version",
                lines.front().log, lines.front().version, line.log, line.version);
}

void require_some_time(const std::vector<const FeatureLine*>& lines) {
    std::set<std::string> dates, logs;
    for (const FeatureLine* line : lines) {
        dates.insert(*line->date);
        logs.insert(line->log);
    }
    if (logs.size() == 1)
        raise<DataError>("{}: one log only; a trend needs at least {} of a joint", *logs.begin(),
                         fewest_trend_lines);
    if (dates.size() == 1)
        raise<DataError>(
            "all {} logs are of {}; a trend needs logs of different days (--date-from-name of 'features' "
            "takes them from the names)",
            logs.size(), *dates.begin());
}

// The lines that can stand in a history: read, with a date, each log and joint once. Throws DataError where
// none are left, and for lines that do not belong together.
std::vector<const FeatureLine*> dated_lines(std::span<const FeatureLine> lines,
                                            std::vector<std::string>& notes) {
    if (lines.empty()) raise<DataError>("no lines; 'ripplenotch features' makes them of logs");
    require_one_version(lines);
    std::vector<const FeatureLine*> dated;
    std::size_t failed = 0, without = 0, twice = 0;
    std::string why;
    for (const FeatureLine& line : lines) {
        if (line.failed()) {
            ++failed;
        } else if (!line.date) {
            if (without++ == 0) why = fmt::format("{}: {}", line.log, line.date_source);
        } else {
            dated.push_back(&line);
        }
    }
    if (failed == lines.size())
        raise<DataError>("all {} lines are of logs that could not be read: {}", failed, lines.front().error);
    if (dated.empty()) raise<DataError>("no line has a date: {}", why);
    const auto key = [](const FeatureLine* line) {
        return std::tie(line->robot, line->joint, *line->date, line->sha256, line->log);
    };
    std::sort(dated.begin(), dated.end(), [&](const auto* a, const auto* b) { return key(a) < key(b); });
    const auto same = [&](const FeatureLine* a, const FeatureLine* b) {
        return a->robot == b->robot && a->joint == b->joint && a->sha256 == b->sha256 && !a->sha256.empty();
    };
    const auto end = std::unique(dated.begin(), dated.end(), same);
    twice = static_cast<std::size_t>(dated.end() - end);
    dated.erase(end, dated.end());
    require_some_time(dated);
    if (failed > 0)
        notes.push_back(fmt::format("{} lines of logs that could not be read are left out", failed));
    if (without > 0) notes.push_back(fmt::format("{} lines without a date are left out: {}", without, why));
    if (twice > 0)
        notes.push_back(
            fmt::format("{} lines are of a log that stands there already; they count once", twice));
    return dated;
}

constexpr double seconds_a_day = 86400.0, days_a_month = 365.25 / 12.0;
constexpr double comparable = 2.5;          // speeds that differ by more are another job of the joint
constexpr double fewest_share = 0.6;        // share of the lines that have to contain a descriptor
constexpr std::size_t lines_for_bend = 20;  // chosen, not derived

// Logs in which the joint moves at quite another speed carry no information on a change.
void leave_out_other_motions(JointHistory& history) {
    std::vector<double> speeds;
    for (const FeatureLine* line : history.lines) speeds.push_back(line->mix.speed_p50_deg_s);
    const double usual = median_of(speeds);
    const std::size_t before = history.lines.size();
    std::erase_if(history.lines, [&](const FeatureLine* line) {
        const double speed = line->mix.speed_p50_deg_s;
        return speed * comparable < usual || speed > comparable * usual;
    });
    if (const std::size_t left_out = before - history.lines.size(); left_out > 0)
        history.notes.push_back(
            fmt::format("{} of {} logs move at less than {:.3g} or more than {:.3g} deg/s; they cannot be "
                        "compared with the others and are left out",
                        left_out, before, usual / comparable, usual * comparable));
}

void add_condition(JointHistory& history, const std::string& name,
                   std::optional<double> (*value_of)(const FeatureLine&)) {
    std::vector<double> values;
    std::size_t missing = 0;
    for (const FeatureLine* line : history.lines) {
        const auto value = value_of(*line);
        missing += value ? 0 : 1;
        values.push_back(value.value_or(0.0));
    }
    if (missing == history.lines.size()) return;
    if (missing > 0) {
        history.notes.push_back(fmt::format("{} of {} logs do not state {}; it is not regressed out", missing,
                                            values.size(), name));
        return;
    }
    const double middle = median_of(values);
    double most = 0.0;
    for (double& value : values) most = std::max(most, std::abs(value -= middle));
    if (most <= 1e-6 * std::abs(middle)) return;  // alike in all logs
    for (double& value : values) value /= most;
    history.conditions.push_back({name, std::move(values)});
}

void add_conditions(JointHistory& history) {
    add_condition(history, "temperature_degc", [](const FeatureLine& line) { return line.temperature_degc; });
    const bool bend = !history.conditions.empty() && history.lines.size() >= lines_for_bend;
    if (bend) {
        // Viscous friction falls with temperature along a curve.
        Condition square{"temperature_degc squared", history.conditions.front().value};
        for (double& value : square.value) value *= value;
        history.conditions.push_back(std::move(square));
    }
    add_condition(history, "load_rms_nm", [](const FeatureLine& line) { return line.mix.load_rms_nm; });
    add_condition(history, "speed_p50_deg_s",
                  [](const FeatureLine& line) { return std::optional(line.mix.speed_p50_deg_s); });
}

// Angles about their mean direction, so that none jumps by a whole turn.
void unwrap(Series& series) {
    double cosine = 0.0, sine = 0.0;
    for (const double angle : series.value) {
        cosine += portable::cos_degrees(angle);
        sine += portable::sin_degrees(angle);
    }
    const double middle = portable::atan2(sine, cosine) * degrees_per_radian;
    for (double& angle : series.value) angle = middle + std::remainder(angle - middle, 360.0);
}

void add_series(JointHistory& history) {
    std::map<std::string, Series> all;
    std::map<std::string, std::string> reasons;
    std::vector<std::string> order;
    for (std::size_t row = 0; row < history.lines.size(); ++row) {
        for (const Descriptor& one : history.lines[row]->descriptors) {
            const auto [at, is_new] = all.try_emplace(one.name());
            Series& series = at->second;
            if (is_new) {
                series.name = one.name();
                order.push_back(one.name());
            }
            if (!one.value) {
                reasons.try_emplace(one.name(), one.reason);
                continue;
            }
            series.rows.push_back(row);
            series.value.push_back(*one.value);
        }
    }
    for (const std::string& name : order) {
        Series& series = all[name];
        const auto fewest = std::max<double>(static_cast<double>(fewest_trend_lines),
                                             fewest_share * static_cast<double>(history.lines.size()));
        if (static_cast<double>(series.rows.size()) < fewest) {
            DescriptorTrend untold;
            untold.name = name;
            untold.lines = series.rows.size();
            untold.reason =
                fmt::format("{} of {} logs have a value{}{}", series.rows.size(), history.lines.size(),
                            reasons.contains(name) ? "; " : "", reasons.contains(name) ? reasons[name] : "");
            history.untold.push_back(std::move(untold));
            continue;
        }
        if (name.ends_with("_phase_deg")) unwrap(series);
        history.series.push_back(std::move(series));
    }
}

}  // namespace

double JointHistory::months() const { return day.empty() ? 0.0 : (day.back() - day.front()) / days_a_month; }

std::vector<JointHistory> joint_histories(std::span<const FeatureLine> lines,
                                          std::vector<std::string>& notes) {
    const std::vector<const FeatureLine*> dated = dated_lines(lines, notes);
    std::map<std::pair<std::string, std::string>, std::vector<const FeatureLine*>> by_joint;
    for (const FeatureLine* line : dated) by_joint[{line->robot, line->joint}].push_back(line);
    std::vector<JointHistory> histories;
    for (auto& [key, own] : by_joint) {
        JointHistory& history = histories.emplace_back();
        std::tie(history.robot, history.joint) = key;
        history.lines = own;
        leave_out_other_motions(history);
        for (const FeatureLine* line : history.lines)
            history.day.push_back(*date_seconds(*line->date) / seconds_a_day);
        if (history.lines.size() < fewest_trend_lines) {
            history.notes.push_back(fmt::format("{} logs that can be compared; a trend needs {}",
                                                history.lines.size(), fewest_trend_lines));
            continue;
        }
        add_conditions(history);
        add_series(history);
    }
    return histories;
}

}  // namespace ripplenotch
