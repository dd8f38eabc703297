// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <utility>

#include "core/rows/second_log.hpp"
#include "ripplenotch/analysis/stretches.hpp"
#include "ripplenotch/log/log.hpp"
#include "ripplenotch/survey/survey.hpp"

namespace ripplenotch {

namespace {

// Range of a signal whose first value is a number.
class Extremes {
  public:
    void add(double value) {
        if (!any_) known_ = std::isfinite(value);
        any_ = true;
        low_ = std::min(low_, value);
        high_ = std::max(high_, value);
    }
    [[nodiscard]] bool known() const { return known_; }
    [[nodiscard]] std::optional<Range> range() const {
        return known_ ? std::optional(Range{low_, high_}) : std::nullopt;
    }

  private:
    double low_ = std::numeric_limits<double>::infinity(), high_ = -low_;
    bool any_ = false, known_ = false;
};

// The figures of a joint's rows, collected in one pass.
class PassingRows {
  public:
    PassingRows(std::size_t rows, Hertz sample_rate)
        : rows_(rows),
          stride_(static_cast<std::size_t>(std::max(1.0, stride_s * sample_rate.value()))),
          rate_hz_(sample_rate.value()) {}

    void add(const TraceView& rows) {
        for (std::size_t k = 0; k < rows.size(); ++k, ++at_) {
            speed_.add(rows.velocity_deg_s[k]);
            torque_.add(rows.torque_nm[k]);
            add_turns(rows, k);
        }
    }
    void describe(JointInfo& joint) const {
        joint.speed_deg_s = speed_.range();
        joint.torque_nm = torque_.range();
        joint.turns = moved_deg_ / 360.0;
    }

  private:
    static constexpr double stride_s = 0.01;  // noise of a position at standstill must not add up to turns

    // Turns of the joint, both directions added up: from position, each stride_-th row and the last, else
    // from velocity over time.
    void add_turns(const TraceView& rows, std::size_t k) {
        if (!rows.has_position()) {
            if (rate_hz_ > 0.0 && speed_.known()) moved_deg_ += std::abs(rows.velocity_deg_s[k]) / rate_hz_;
            return;
        }
        if (at_ == 0) strode_from_deg_ = rows.position_deg[k];
        if (at_ % stride_ != 0 && at_ + 1 != rows_) return;
        moved_deg_ += std::abs(rows.position_deg[k] - strode_from_deg_);
        strode_from_deg_ = rows.position_deg[k];
    }

    std::size_t rows_, stride_, at_ = 0;
    double rate_hz_;
    Extremes speed_, torque_;
    double moved_deg_ = 0.0, strode_from_deg_ = 0.0;
};

// Means of so many consecutive rows each, as a trace of its own, at a rate that is as much lower.
class PassingMeans {
  public:
    /// Of as few rows as `max_means` allow.
    PassingMeans(std::size_t rows, Hertz sample_rate, std::size_t max_means)
        : in_mean_((rows + max_means - 1) / max_means) {
        means_.sample_rate = Hertz(sample_rate.value() / static_cast<double>(in_mean_));
    }

    void add(const TraceView& rows) {
        begins_run_ = begins_run_ || (!rows.run_starts.empty() && any_);
        for (std::size_t k = 0; k < rows.size(); ++k) {
            any_ = true;
            sums_.time_s += rows.time_s[k];
            sums_.velocity_deg_s += rows.velocity_deg_s[k];
            sums_.torque_nm += rows.torque_nm[k];
            if (rows.has_position()) sums_.position_deg += rows.position_deg[k];
            if (++sums_.rows == in_mean_) end_mean(rows.has_position());
        }
        by_position_ = rows.has_position();
    }
    [[nodiscard]] Trace take() {
        if (sums_.rows > 0) end_mean(by_position_);
        return std::move(means_);
    }

  private:
    struct Sums {
        std::size_t rows = 0;
        double time_s = 0.0, velocity_deg_s = 0.0, torque_nm = 0.0, position_deg = 0.0;
    };

    // A gap within the rows of a mean is placed before the mean, which is accurate enough for a stretch of
    // seconds.
    void end_mean(bool by_position) {
        const auto rows = static_cast<double>(sums_.rows);
        if (std::exchange(begins_run_, false) && means_.size() > 0)
            means_.run_starts.push_back(means_.size());
        means_.time_s.push_back(sums_.time_s / rows);
        means_.velocity_deg_s.push_back(sums_.velocity_deg_s / rows);
        means_.torque_nm.push_back(sums_.torque_nm / rows);
        if (by_position) means_.position_deg.push_back(sums_.position_deg / rows);
        sums_ = {};
    }

    std::size_t in_mean_;
    bool any_ = false, by_position_ = false, begins_run_ = false;
    Sums sums_;
    Trace means_;
};

std::vector<SteadyStretch> stretches_of(const Log& log) {
    std::vector<SteadyStretch> stretches;
    const bool usable = log.trace.sample_rate.value() > 0.0 &&
                        std::isfinite(log.trace.velocity_deg_s.front()) &&
                        std::isfinite(log.trace.time_s.front());
    if (!usable) return stretches;
    for (const Stretch& stretch : steady_stretches(log.trace.view())) {
        stretches.push_back(
            {log.trace.time_s[stretch.first], stretch.duration.value(), stretch.speed.value(), stretch.rest});
    }
    return stretches;
}

// Empty for a joint that does not move.
std::string second_log_of(const Trace& trace) {
    const MotionSeen seen = motion_seen(trace.velocity_deg_s);
    if (seen.positive + seen.negative <= 0.0) return {};
    return second_log(seen, {.direction = true, .speed = true, .load = true});
}

/// One joint, and the description of its log: no rows.
struct Surveyed {
    Log log;
    JointInfo info;
};

Surveyed surveyed(Log log) {
    JointInfo joint;
    PassingRows rows(log.trace.size(), log.trace.sample_rate);
    rows.add(log.trace.view());
    rows.describe(joint);
    joint.stretches = stretches_of(log);
    joint.second_log = second_log_of(log.trace);
    log.trace = {};
    return {std::move(log), std::move(joint)};
}

// A log that is too long for memory is read twice, and its motion is determined from the means of many rows.
Surveyed survey_long(const std::shared_ptr<const Spool>& spool, const ReadOptions& options,
                     std::size_t most_rows) {
    LogPasses passes(spool, options);
    Surveyed found;
    passes.first();
    const std::size_t count = passes.facts().rows;
    const Hertz sample_rate = passes.log().trace.sample_rate;
    PassingRows rows(count, sample_rate);
    PassingMeans means(count, sample_rate, most_rows);
    passes.second([&](const TraceView& part) {
        rows.add(part);
        means.add(part);
    });
    found.log = passes.log();
    rows.describe(found.info);
    Log thinned;
    thinned.trace = means.take();
    found.info.stretches = stretches_of(thinned);
    found.info.second_log = second_log_of(thinned.trace);
    return found;
}

Surveyed survey_joint(const std::shared_ptr<const Spool>& spool, const ReadOptions& options,
                      std::size_t most_rows) {
    if (auto whole = read_log_if_short(*spool, options, most_rows)) return surveyed(std::move(*whole));
    return survey_long(spool, options, most_rows);
}

std::vector<Surveyed> survey_joints(const std::string& path, const ReadOptions& options,
                                    std::size_t most_rows) {
    const auto spool = std::make_shared<const Spool>(path);
    std::vector<Surveyed> all;
    for (Log& log : read_each_if_short(*spool, options, 4 * most_rows))
        all.push_back(surveyed(std::move(log)));
    if (all.empty()) {
        std::vector<std::string> joints = asked_joints(*spool, options).names;
        if (joints.empty()) joints.emplace_back();
        ReadOptions one = options;
        for (const std::string& joint : joints) {
            one.joint = joint.empty() ? std::nullopt : std::optional<std::string>(joint);
            all.push_back(survey_joint(spool, one, most_rows));
        }
    }
    for (auto& [log, info] : all) {
        info.joint = log.layout.chosen.joint;
        if (log.position_range_deg)
            info.position_deg = Range{log.position_range_deg->first, log.position_range_deg->second};
        info.recording = log.recording;
        info.clock_factor = log.clock_factor;
        info.options = log.layout.options;
    }
    return all;
}

// Several joints with the same warning share one, with the text of the first.
void add_warnings(LogInfo& info, const std::vector<Surveyed>& joints) {
    struct Told {
        const LogWarning* first;
        std::vector<std::string> joints;
    };
    std::vector<Told> all;
    for (const Surveyed& joint : joints) {
        const Log& log = joint.log;
        for (const std::vector<LogWarning>* list : {&log.layout.warnings, &log.recording.warnings}) {
            for (const LogWarning& warning : *list) {
                auto same = std::find_if(all.begin(), all.end(), [&](const Told& told) {
                    return told.first->about == warning.about &&
                           (warning.of_one_joint || told.first->text == warning.text);
                });
                if (same == all.end()) same = all.insert(same, {&warning, {}});
                same->joints.push_back(log.layout.chosen.joint);
            }
        }
    }
    for (const Told& told : all) {
        std::string text = told.first->text;
        if (joints.size() > 1 && (told.first->of_one_joint || told.joints.size() < joints.size())) {
            const auto others = std::span(told.joints).subspan(1);
            text = fmt::format(
                "joint {}{}: {}", told.joints.front(),
                others.empty() ? "" : fmt::format(" (and likewise {})", fmt::join(others, ", ")), text);
        }
        info.warnings.push_back(text);
    }
}

std::string speeds_text(const std::vector<SteadyStretch>& stretches) {
    std::string text;
    std::size_t shown = 0;
    for (const SteadyStretch& stretch : stretches) {
        if (stretch.rest) continue;
        if (++shown > 4) return text + ", ...";
        text += fmt::format("{}{:.3g} deg/s ({:.3g} s)", text.empty() ? "" : ", ", stretch.speed_deg_s,
                            stretch.duration_s);
    }
    return text;
}

// The joint that turned most decides the suitability of the whole log.
void state_uses(LogInfo& info, bool makes_torque) {
    const auto most =
        std::max_element(info.joints.begin(), info.joints.end(),
                         [](const JointInfo& a, const JointInfo& b) { return a.turns < b.turns; });
    const JointInfo none;
    const JointInfo& joint = most == info.joints.end() ? none : *most;
    const std::string missing =
        !joint.torque_nm ? "no torque column; --columns torque=NAME names one"
        : !joint.speed_deg_s
            ? "no velocity column; --columns velocity=NAME names one, --constant-speed 60rpm states it"
            : info.clock.refusal;
    const std::string speeds = speeds_text(joint.stretches);
    const std::string of_joint = info.joints.size() > 1 ? fmt::format("joint {}: ", joint.joint) : "";

    Use spectrum{"spectrum", missing.empty(), missing};
    if (missing.empty()) {
        spectrum.reason = speeds.empty() ? of_joint +
                                               "no speed is held for 1 s: a spectrum of the whole log, lines "
                                               "smeared by its speed range"
                                         : of_joint + "steady at " + speeds;
    }
    Use identify{"identify", missing.empty() && joint.turns > 0.05, missing};
    if (missing.empty()) {
        const double top = 0.5 * joint.recording.update_rate().value();
        const double speed = std::max(std::abs(joint.speed_deg_s->min), std::abs(joint.speed_deg_s->max));
        const std::string turns = fmt::format("{:.3g}", joint.turns);
        identify.reason = fmt::format(
            "{}{} turn{} of the joint at up to {:.3g} deg/s; lines below {:.0f} cycles per turn stay under "
            "half the {} rate at that speed",
            of_joint, turns, turns == "1" ? "" : "s", speed, 360.0 * top / std::max(speed, 1e-9),
            joint.recording.update_rate() < info.clock.nominal_rate ? "update" : "sample");
        if (!identify.possible)
            identify.reason = fmt::format("{}the joint turns by {:.3g} of a turn: too little for any line",
                                          of_joint, joint.turns);
    }
    Use filter{"filter", missing.empty(), missing};
    if (missing.empty()) {
        filter.reason = info.clock.gap_count == 0
                            ? "the clock runs without gaps"
                            : fmt::format("in {} runs, one between gaps", info.clock.gap_count + 1);
        if (info.clock.rows_left_out > 0)
            filter.reason +=
                fmt::format("; {} rows at another rate pass unfiltered", info.clock.rows_left_out);
    }
    Use clock{"clock-check", joint.clock_factor.has_value() && info.clock.refusal.empty(),
              "position and velocity can be compared"};
    if (!clock.possible) {
        clock.reason = !info.clock.refusal.empty() ? info.clock.refusal
                       : !joint.position_deg
                           ? "no position column"
                           : "too few rows, too little motion, or position and velocity of different things";
    }
    if (joint.torque_nm && !joint.speed_deg_s && info.clock.refusal.empty()) {
        spectrum = {"spectrum", true, "over frequency; " + missing};
        filter = {"filter", true,
                  "by methods that are the same at every speed, fixed and lowpass; " + missing};
    }
    const bool is_made = makes_torque && joint.speed_deg_s && info.clock.refusal.empty();
    Use diagnose{"diagnose", (missing.empty() || is_made) && !joint.second_log.empty(), missing};
    if (missing.empty() || is_made)
        diagnose.reason = of_joint + (diagnose.possible ? joint.second_log : "the joint does not move");
    else if (!joint.torque_nm && joint.position_deg)
        diagnose.reason += ", or --drive makes it of a command";
    info.uses = {spectrum, identify, filter, clock, diagnose};
}

// A log of unknown columns is described like any other, since `info` is the command to inspect one.
void warn_where_nothing_is_known(LogInfo& info) {
    const auto& columns = info.layout.columns;
    if (!std::all_of(columns.begin(), columns.end(),
                     [](const Column& column) { return column.role == Role::other; }))
        return;
    info.warnings.emplace_back(
        "no column is known as time, velocity, torque or position, so no command can use this log as it is; "
        "state which is which, by name or number: --columns time=NAME,velocity=NAME,torque=NAME");
}

}  // namespace

LogInfo survey_log(const std::string& path, ReadOptions options, std::size_t most_rows, bool makes_torque) {
    options.needs_torque = false;
    const std::vector<Surveyed> joints = survey_joints(path, options, most_rows);
    LogInfo info;
    const Log& first = joints.front().log;
    info.source = first.layout.source;
    info.layout = first.layout;
    info.rows = first.recording.rows();
    info.clock = first.recording.clock;
    if (first.layout.chosen.time || first.layout.stated_rate)
        info.duration_s = info.clock.last_s - info.clock.first_s;
    for (const Surveyed& joint : joints) {
        const Log& log = joint.log;
        info.joints.push_back(joint.info);
        info.bad_values_held = std::max(info.bad_values_held, log.held_bad_values);
        // What a joint chose among its columns is known by its own reading.
        const std::string& name = log.layout.chosen.joint;
        for (std::size_t c = 0; c < info.layout.columns.size(); ++c) {
            const Column& own = log.layout.columns[c];
            if (own.role == Role::time) continue;
            if (own.joint == name || info.layout.columns[c].joint == name) info.layout.columns[c] = own;
        }
    }
    warn_where_nothing_is_known(info);
    add_warnings(info, joints);
    state_uses(info, makes_torque);
    return info;
}

}  // namespace ripplenotch
