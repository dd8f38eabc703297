// SPDX-License-Identifier: MIT
#include "ripplenotch/log/passes.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "log/clock_check.hpp"
#include "log/plausibility.hpp"
#include "log/step_watch.hpp"
#include "log/unwrap.hpp"
#include "ripplenotch/core/spool.hpp"
#include "ripplenotch/log/log.hpp"

namespace ripplenotch {

class LogPasses::Work {
  public:
    Work(const std::string& path, ReadOptions options)
        : spool_(path), options_(std::move(options)), reader_(open_log(spool_.open(), options_)) {}

    void first(const Take& take);
    void second(const Take& take);
    void again(const Take& take);

    Layout layout;
    LogFacts facts;
    std::vector<std::string> warnings;

  private:
    void run(const Take& take);
    void look_at(const TraceView& rows);
    void find_usual_step();

    Spool spool_;
    ReadOptions options_;
    std::unique_ptr<LogReader> reader_;  ///< of the pass that comes next; made when it begins, but the first
    StepWatch steps_{default_gap_steps};
    WrapWatch wrap_;
    double sum_s_ = 0.0;
    bool timed_ = false, moves_ = false;  ///< the first row has a time, a velocity
    LogExtremes extremes_;
};

void LogPasses::Work::run(const Take& take) {
    if (!reader_) reader_ = open_log(spool_.open(), options_);
    RowBlock block;
    while (reader_->next(block)) {
        if (block.size() == 0) continue;
        const JointRows& joint = block.joints.front();
        take({facts.sample_rate, block.time_s, joint.velocity_deg_s, joint.torque_nm, joint.position_deg});
    }
    if (facts.rows == 0) layout = reader_->layout();
    reader_.reset();
}

void LogPasses::Work::look_at(const TraceView& rows) {
    if (extremes_.rows == 0) {
        facts.first_s = rows.time_s.front();
        timed_ = std::isfinite(facts.first_s);
        moves_ = std::isfinite(rows.velocity_deg_s.front());
    }
    extremes_.rows += rows.size();
    facts.last_s = rows.time_s.back();
    for (const double time : rows.time_s) sum_s_ += time;
    for (const double speed : rows.velocity_deg_s)
        extremes_.speed_deg_s = std::max(extremes_.speed_deg_s, std::abs(speed));
    if (timed_) steps_.take(rows.time_s);
    wrap_.take(rows.position_deg);
    if (rows.has_position()) extremes_.position_deg = wrap_.largest();
}

// The guess from the first rows was no good: the median itself, and once more what it decides.
void LogPasses::Work::find_usual_step() {
    StepOfRank usual(steps_.usual_rank());
    do {
        run([&](const TraceView& rows) { usual.take(rows.time_s); });
    } while (usual.next_digit());
    steps_ = StepWatch(default_gap_steps, usual.value());
    run([&](const TraceView& rows) { steps_.take(rows.time_s); });
}

void LogPasses::Work::first(const Take& take) {
    run([&](const TraceView& rows) {
        look_at(rows);
        take(rows);
    });
    facts.rows = extremes_.rows;
    if (!steps_.settled()) find_usual_step();
    const auto rows = static_cast<double>(facts.rows);
    facts.mean_s = sum_s_ / rows;
    facts.mean_position_deg = wrap_.sum() / rows;
    facts.sample_rate = layout.stated_rate.value_or(steps_.sample_rate());
    extremes_.sample_rate = facts.sample_rate;
    require_rate(layout, extremes_, options_);
    for (std::string& warning : doubts(layout, wrap_.period(), extremes_))
        layout.warnings.push_back(std::move(warning));
}

void LogPasses::Work::again(const Take& take) {
    std::optional<Unwrapper> unwrapper;
    if (const auto period = wrap_.period()) unwrapper.emplace(*period);
    std::vector<double> position;
    run([&](const TraceView& rows) {
        TraceView continuous = rows;
        if (unwrapper) {
            position.assign(rows.position_deg.begin(), rows.position_deg.end());
            unwrapper->apply(position);
            continuous.position_deg = position;
        }
        take(continuous);
    });
}

void LogPasses::Work::second(const Take& take) {
    HeldCounter held(extremes_.speed_deg_s);
    MotionPieces motion(facts.rows, steps_.gap_s());
    again([&](const TraceView& rows) {
        held.take(rows);
        if (timed_ && moves_) motion.take(rows);
        take(rows);
    });
    if (facts.rows < 2) return;
    ClockTroubles troubles = steps_.troubles();
    troubles.rows = facts.rows;
    troubles.held = held.held();
    if (held.needs_grain() && worth_telling(troubles, troubles.held.count)) {
        again([&](const TraceView& rows) { held.take_grain(rows); });
        troubles.held = held.held();
    }
    warnings = timebase_warnings(troubles);
    ClockCheck check = motion.check(steps_.sample_rate());
    if (!check.warning.empty()) warnings.push_back(std::move(check.warning));
}

LogPasses::LogPasses(const std::string& path, const ReadOptions& options)
    : work_(std::make_unique<Work>(path, options)) {}
LogPasses::~LogPasses() = default;

void LogPasses::first(const Take& take) { work_->first(take); }
void LogPasses::second(const Take& take) { work_->second(take); }
void LogPasses::again(const Take& take) { work_->again(take); }
const LogFacts& LogPasses::facts() const { return work_->facts; }
const Layout& LogPasses::layout() const { return work_->layout; }
const std::vector<std::string>& LogPasses::warnings() const { return work_->warnings; }

}  // namespace ripplenotch
