// SPDX-License-Identifier: MIT
#include "ripplenotch/log/passes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "log/account/account.hpp"
#include "log/account/unwrap.hpp"
#include "log/clock/clock_check.hpp"
#include "log/kept_parts.hpp"
#include "ripplenotch/log/log.hpp"

namespace ripplenotch {

class LogPasses::Work {
  public:
    Work(std::shared_ptr<const Spool> log, ReadOptions options, std::size_t joint)
        : spool_(std::move(log)),
          options_(std::move(options)),
          joint_(joint),
          reader_(open_log(spool_->open(), options_)) {}

    void first(const Use& use);
    void second(const Use& use);
    void again(const Use& use);

    Layout layout;
    LogFacts facts;
    Recording recording;
    KeptParts kept{0};

  private:
    Account run(const Use& use);
    void look_at(const TraceView& rows);

    void go_on_from(const Use& logged, const Use& use);

    std::shared_ptr<const Spool> spool_;
    ReadOptions options_;
    std::size_t joint_;
    std::unique_ptr<LogReader> reader_;  ///< of the pass that comes next; made when it begins, but the first
    WrapWatch wrap_;
    std::size_t rows_ = 0;
    double sum_s_ = 0.0;
    bool has_position_ = false;
};

Account LogPasses::Work::run(const Use& use) {
    if (!reader_) reader_ = open_log(spool_->open(), options_);
    Opening opening = read_opening(*reader_);
    Account account(reader_->layout(), opening);
    constexpr std::array<std::size_t, 1> at_first_row = {0};
    RowBlock block;
    std::size_t held_bad_values = 0;
    while (next_block(opening, *reader_, block)) {
        held_bad_values += block.held_bad_values;
        for (const RunPart& part : account.add(block)) {
            if (!part.usable || part.count == 0) continue;
            TraceView rows = view_of(block, joint_, part.first, part.count);
            rows.sample_rate = facts.sample_rate;
            if (part.begins_run) rows.run_starts = at_first_row;
            use(rows);
        }
    }
    if (options_.needs_torque) account.clock().require();
    if (facts.rows == 0) layout = reader_->layout();
    facts.held_bad_values = held_bad_values;
    reader_.reset();
    return account;
}

void LogPasses::Work::look_at(const TraceView& rows) {
    if (rows_ == 0) facts.first_s = rows.time_s.front();
    rows_ += rows.size();
    facts.last_s = rows.time_s.back();
    for (const double time : rows.time_s) sum_s_ += time;
    wrap_.follow(rows.position_deg);
    has_position_ = has_position_ || rows.has_position();
}

void LogPasses::Work::first(const Use& use) {
    const Account account = run([&](const TraceView& rows) {
        look_at(rows);
        kept.add(rows);
        use(rows);
    });
    facts.rows = rows_;
    recording = account.recording(layout, joint_);
    const auto rows = static_cast<double>(facts.rows);
    facts.mean_s = sum_s_ / rows;
    const bool by_position = recording.angle.source() == AngleFacts::Source::position;
    const double sign = recording.angle.verdict == AngleFacts::Verdict::reversed ? -1.0 : 1.0;
    if (by_position && has_position_) facts.mean_position_deg = sign * wrap_.sum() / rows;
    facts.sample_rate = recording.clock.mean_rate;
    if (const auto period = wrap_.period())
        layout.warnings.push_back({"wrapped position", wrap_in_words(*period), true});
}

void LogPasses::Work::again(const Use& use) {
    go_on_from([](const TraceView&) {}, use);
}

// `logged` gets the rows with the position as it was logged, made continuous; then `use` gets the joint's.
void LogPasses::Work::go_on_from(const Use& logged_use, const Use& use) {
    std::optional<Unwrapper> unwrapper;
    if (const auto period = wrap_.period()) unwrapper.emplace(*period);
    std::vector<double> continuous;
    JointsPosition joints;
    const auto go_on = [&](const TraceView& logged) {
        TraceView rows = logged;
        if (unwrapper) {
            continuous.assign(rows.position_deg.begin(), rows.position_deg.end());
            unwrapper->apply(continuous);
            rows.position_deg = continuous;
        }
        logged_use(rows);
        rows.position_deg = joints.of(recording.angle, rows);
        use(rows);
    };
    if (kept.whole())
        kept.replay(facts.sample_rate, go_on);
    else
        static_cast<void>(run(go_on));
}

// As read_log compares the clock with the motion: by the joint's position; by the logged one where that is
// not the joint's, or runs the other way.
void LogPasses::Work::second(const Use& use) {
    MotionPieces motion(facts.rows);
    const bool turned = recording.angle.verdict == AngleFacts::Verdict::reversed;
    double low = std::numeric_limits<double>::infinity(), high = -low;
    TraceView as_logged;
    const auto look_at = [&](const TraceView& rows) {
        as_logged = rows;
        for (const double angle : rows.position_deg) {
            low = std::min(low, angle);
            high = std::max(high, angle);
        }
    };
    go_on_from(look_at, [&](const TraceView& rows) {
        motion.add(turned || !rows.has_position() ? as_logged : rows);
        use(rows);
    });
    const ClockCheck check = motion.check(facts.sample_rate);
    facts.clock_factor = check.factor;
    if (low <= high) facts.position_range_deg.emplace(low, high);
    recording.warnings = recording_warnings(recording, check.warning);
}

LogPasses::LogPasses(const std::string& path, const ReadOptions& options)
    : LogPasses(std::make_shared<const Spool>(path), options) {}
LogPasses::LogPasses(std::shared_ptr<const Spool> log, const ReadOptions& options, std::size_t joint)
    : work_(std::make_unique<Work>(std::move(log), options, joint)) {}
LogPasses::~LogPasses() = default;

void LogPasses::keep_rows(std::size_t most_bytes) { work_->kept = KeptParts(most_bytes / sizeof(double)); }
void LogPasses::first(const Use& use) { work_->first(use); }
void LogPasses::second(const Use& use) { work_->second(use); }
void LogPasses::again(const Use& use) { work_->again(use); }
const LogFacts& LogPasses::facts() const { return work_->facts; }
const Layout& LogPasses::layout() const { return work_->layout; }
const Recording& LogPasses::recording() const { return work_->recording; }

}  // namespace ripplenotch
