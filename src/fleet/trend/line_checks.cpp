// SPDX-License-Identifier: MIT
#include "fleet/trend/line_checks.hpp"

#include <algorithm>
#include <set>
#include <tuple>

#include "ripplenotch/core/error.hpp"

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
            "all {} logs are of {}; a trend needs logs of different days (--date-from-name of "
            "'features' takes them from the names)",
            logs.size(), *dates.begin());
}

std::string name_and_day(const JointHistory& history, bool first) {
    const FeatureLine& line = first ? *history.lines.front() : *history.lines.back();
    return fmt::format("'{}' {} on {}", history.name(), first ? "begins" : "ends", line.date->substr(0, 10));
}

}  // namespace

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

void note_new_names(const std::vector<JointHistory>& histories, std::vector<std::string>& notes) {
    if (histories.size() < 2) return;
    for (const JointHistory& old : histories) {
        for (const JointHistory& young : histories) {
            if (old.robot != young.robot || old.lines.size() < 3 || young.lines.size() < 3) continue;
            if (!(*old.lines.back()->date < *young.lines.front()->date)) continue;
            notes.push_back(fmt::format("{} and {}: if this is one joint, give its lines one name",
                                        name_and_day(old, false), name_and_day(young, true)));
        }
    }
}

}  // namespace ripplenotch
