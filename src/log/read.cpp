// SPDX-License-Identifier: MIT
// Whole logs in memory, with an account of them.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <tuple>
#include <utility>

#include "log/account/account.hpp"
#include "log/clock/clock_check.hpp"
#include "ripplenotch/log/log.hpp"

namespace ripplenotch {

namespace {

void append(std::vector<double>& to, std::span<const double> from) {
    to.insert(to.end(), from.begin(), from.end());
}

void append(Trace& trace, const TraceView& rows, bool begins_run) {
    if (begins_run && trace.size() > 0) trace.run_starts.push_back(trace.size());
    append(trace.time_s, rows.time_s);
    append(trace.velocity_deg_s, rows.velocity_deg_s);
    append(trace.torque_nm, rows.torque_nm);
    append(trace.position_deg, rows.position_deg);
}

// Few and long: half a minute at 1 kHz, in which a slow joint still turns and lines stand apart.
constexpr std::size_t most_pieces = 16;
// A million rows of time, speed, torque and position: less than what then looks at the pieces takes.
constexpr std::size_t most_bytes_kept = std::size_t{32} << 20;

/// Pieces of a log with more than `most_rows`, nothing of a shorter one. See read_log_in_part. `joint`: by
/// its place, where options.every_joint reads several.
std::optional<Log> read_pieces(const std::shared_ptr<const Spool>& log, const ReadOptions& options,
                               std::size_t most_rows, std::size_t joint = 0) {
    LogPasses passes(log, options, joint);
    passes.keep_rows(most_bytes_kept);
    passes.first();
    const std::size_t rows = passes.facts().rows;
    if (rows <= most_rows) return std::nullopt;
    const std::size_t in_piece = std::max<std::size_t>(1, most_rows / most_pieces);
    const std::size_t from_piece_to_piece = (rows - in_piece) / (most_pieces - 1);
    Trace trace;
    for (auto* column : {&trace.time_s, &trace.velocity_deg_s, &trace.torque_nm})
        column->reserve(in_piece * most_pieces);
    std::size_t at = 0, piece = 0;
    passes.second([&](const TraceView& part) {
        const std::size_t first = std::exchange(at, at + part.size());
        for (; piece < most_pieces; ++piece) {
            const std::size_t begin = piece * from_piece_to_piece, end = begin + in_piece;
            const std::size_t from = std::max(first, begin), to = std::min(at, end);
            if (part.has_position()) trace.position_deg.reserve(in_piece * most_pieces);
            if (from < to)
                append(trace, part.part(from - first, to - from),
                       from == begin || (from == first && !part.run_starts.empty()));
            if (end > at) return;
        }
    });
    Log part = passes.log();
    std::tie(trace.source, trace.joint, trace.sample_rate) =
        std::tie(part.trace.source, part.trace.joint, part.trace.sample_rate);
    part.trace = std::move(trace);
    part.recording.looked_at = LookedAt{part.trace.size(), most_pieces};
    part.recording.warnings.push_back({"looked at in part",
                                       fmt::format("{}: of {} rows {} are examined, in {} evenly spaced "
                                                   "pieces; --from and --to select a part that is read whole",
                                                   part.layout.source, rows, part.trace.size(), most_pieces),
                                       true});
    return part;
}

// What is known when all rows have gone by once; `joint` of the account stands at `place` of the layout.
void know(Log& log, const Account& account, std::size_t place, std::size_t joint,
          std::optional<double> wrap) {
    log.recording = account.recording(log.layout, place, joint);
    log.layout.chosen = log.layout.all_chosen()[place];
    log.layout.others.clear();
    log.trace.source = log.layout.source;
    log.trace.joint = log.layout.chosen.joint;
    log.trace.sample_rate = log.recording.clock.mean_rate;
    if (wrap) log.layout.warn("wrapped position", wrap_in_words(*wrap), true);
}

/// The rows once more, in memory or in passing: their position made continuous, and then the joint's.
class SecondLook {
  public:
    /// `log`: as know() leaves it. `rows` of all of it.
    SecondLook(Log& log, std::optional<double> wrap, std::size_t rows) : log_(log), motion_(rows) {
        if (wrap) unwrapper_.emplace(*wrap);
    }
    /// The next rows as they were logged, with the joint's position in place of theirs. Valid until the next
    /// call.
    TraceView joints(TraceView rows) {
        if (unwrapper_) {
            continuous_.assign(rows.position_deg.begin(), rows.position_deg.end());
            unwrapper_->apply(continuous_);
            rows.position_deg = continuous_;
        }
        for (const double angle : rows.position_deg) {
            low_ = std::min(low_, angle);
            high_ = std::max(angle, high_);  // of equal zeros the last one, with its sign
        }
        TraceView joints = rows;
        joints.position_deg = position_.of(log_.recording.angle, rows);
        // One that is not the joint's, or runs the other way, is held against the clock as it was logged.
        const bool reversed = log_.recording.angle.verdict == AngleFacts::Verdict::reversed;
        motion_.add(reversed || !joints.has_position() ? rows : joints);
        return joints;
    }
    void finish() {
        const ClockCheck check = motion_.check(log_.trace.sample_rate);
        log_.clock_factor = check.factor;
        if (low_ <= high_) log_.position_range_deg.emplace(low_, high_);
        log_.recording.warnings = recording_warnings(log_.recording, check.warning);
    }

  private:
    Log& log_;
    MotionPieces motion_;
    std::optional<Unwrapper> unwrapper_;
    std::vector<double> continuous_;
    JointsPosition position_;
    double low_ = std::numeric_limits<double>::infinity(), high_ = -low_;
};

void finish(Log& log, const Account& account, const LogReader& reader, std::size_t joint) {
    const Layout& whole = reader.layout();
    log.layout = whole.each.empty() ? whole : whole.each[joint];
    const auto wrap = wrap_period(log.trace.position_deg);
    know(log, account, whole.each.empty() ? joint : 0, joint, wrap);
    SecondLook look(log, wrap, log.trace.size());
    const auto position = look.joints(log.trace.view()).position_deg;
    log.trace.position_deg = std::vector<double>(position.begin(), position.end());
    look.finish();
}

// Empty where there are more than `most_rows`.
std::vector<Log> read_all_joints(LogReader& reader, const ReadOptions& options,
                                 std::size_t most_rows = all_rows) {
    Opening opening = read_opening(reader);
    Account account(reader.layout(), opening);
    std::vector<Log> logs(reader.layout().all_chosen().size());
    RowBlock block;
    while (next_block(opening, reader, block)) {
        for (const RunPart& part : account.add(block)) {
            for (std::size_t j = 0; j < logs.size() && part.usable; ++j)
                append(logs[j].trace, view_of(block, j, part.first, part.count), part.begins_run);
        }
        for (Log& log : logs) log.held_bad_values += block.held_bad_values;
        if (logs.front().trace.size() > most_rows) return {};
    }
    if (options.needs_torque) account.clock().require();
    for (std::size_t j = 0; j < logs.size(); ++j) finish(logs[j], account, reader, j);
    return logs;
}

// By the size of the file and of its first rows. Where it is wrong, the log is read once more.
bool looks_longer(const Spool& spool, const ReadOptions& options, std::size_t rows) {
    constexpr double margin = 1.2;
    auto source = spool.open();
    const auto size = static_cast<double>(source->size());
    const auto reader = open_log(std::move(source), options);
    RowBlock block;
    if (options.range.given() || !reader->next(block)) return false;
    const double row = static_cast<double>(block.bytes.size()) / static_cast<double>(block.size());
    return size > margin * static_cast<double>(rows) * row && row > 0.0;
}

Log in_part(const std::shared_ptr<const Spool>& spool, const ReadOptions& options, std::size_t most_rows) {
    const bool all = most_rows == all_rows;
    if (!all && looks_longer(*spool, options, most_rows)) {
        if (auto pieces = read_pieces(spool, options, most_rows)) return std::move(*pieces);
    }
    if (auto whole = read_log_if_short(*spool, options, most_rows)) return std::move(*whole);
    return read_pieces(spool, options, most_rows).value();
}

}  // namespace

class LogPasses::Work {
  public:
    Work(std::shared_ptr<const Spool> spool, ReadOptions options, std::size_t joint)
        : spool_(std::move(spool)),
          options_(std::move(options)),
          joint_(joint),
          reader_(open_log(spool_->open(), options_)) {}

    void first();
    void second(const Use& use);

    Log log;
    LogFacts facts;
    std::size_t most_kept = 0;  ///< numbers, of rows that are kept for the pass behind the first

  private:
    Account run(const Use& use);

    std::shared_ptr<const Spool> spool_;
    ReadOptions options_;
    std::size_t joint_;
    std::unique_ptr<LogReader> reader_;  ///< of the pass that comes next; made when it begins, but the first
    WrapWatch wrap_;
    std::vector<Trace> kept_;  ///< the parts of the first pass, where all of them are
};

Account LogPasses::Work::run(const Use& use) {
    if (!reader_) reader_ = open_log(spool_->open(), options_);
    Opening opening = read_opening(*reader_);
    Account account(reader_->layout(), opening);
    constexpr std::array<std::size_t, 1> at_first_row = {0};
    RowBlock block;
    log.held_bad_values = 0;
    while (next_block(opening, *reader_, block)) {
        log.held_bad_values += block.held_bad_values;
        for (const RunPart& part : account.add(block)) {
            if (!part.usable || part.count == 0) continue;
            TraceView rows = view_of(block, joint_, part.first, part.count);
            rows.sample_rate = log.trace.sample_rate;
            if (part.begins_run) rows.run_starts = at_first_row;
            use(rows);
        }
    }
    if (options_.needs_torque) account.clock().require();
    reader_.reset();
    return account;
}

void LogPasses::Work::first() {
    log.layout = reader_->layout();
    double sum_s = 0.0;
    bool has_position = false;
    const Account account = run([&](const TraceView& rows) {
        facts.rows += rows.size();
        for (const double time : rows.time_s) sum_s += time;
        wrap_.follow(rows.position_deg);
        has_position = has_position || rows.has_position();
        if (4 * facts.rows > most_kept) {
            kept_.clear();
        } else {
            append(kept_.emplace_back(), rows, false);
            kept_.back().run_starts.assign(rows.run_starts.begin(), rows.run_starts.end());
        }
    });
    know(log, account, joint_, joint_, wrap_.period());
    const AngleFacts& angle = log.recording.angle;
    const auto rows = static_cast<double>(facts.rows);
    facts.mean_s = sum_s / rows;
    const bool by_position = angle.source() == AngleFacts::Source::position;
    const double sign = angle.verdict == AngleFacts::Verdict::reversed ? -1.0 : 1.0;
    if (by_position && has_position) facts.mean_position_deg = sign * wrap_.sum() / rows;
}

void LogPasses::Work::second(const Use& use) {
    SecondLook look(log, wrap_.period(), facts.rows);
    const auto go_on = [&](const TraceView& rows) { use(look.joints(rows)); };
    if (kept_.empty()) static_cast<void>(run(go_on));
    for (const Trace& part : kept_) {
        TraceView rows = part.view();
        rows.sample_rate = log.trace.sample_rate;
        go_on(rows);
    }
    look.finish();
}

LogPasses::LogPasses(const std::string& path, const ReadOptions& options)
    : LogPasses(std::make_shared<const Spool>(path), options) {}

LogPasses::LogPasses(std::shared_ptr<const Spool> log, const ReadOptions& options, std::size_t joint)
    : work_(std::make_unique<Work>(std::move(log), options, joint)) {}

LogPasses::~LogPasses() = default;

void LogPasses::keep_rows(std::size_t most_bytes) { work_->most_kept = most_bytes / sizeof(double); }

void LogPasses::first() { work_->first(); }

void LogPasses::second(const Use& use) { work_->second(use); }

const LogFacts& LogPasses::facts() const { return work_->facts; }

const Log& LogPasses::log() const { return work_->log; }

Log read_log(LogReader& reader, const ReadOptions& options) {
    return std::move(read_all_joints(reader, options).front());
}

std::vector<Log> read_joints_at_once(const std::string& path, const ReadOptions& options,
                                     std::size_t most_rows) {
    const auto spool = std::make_shared<const Spool>(path);
    ReadOptions every = options;
    every.joint.reset();
    every.every_joint = true;
    std::vector<Log> logs;
    if (most_rows == all_rows || !looks_longer(*spool, every, most_rows)) {
        logs = read_all_joints(*open_log(spool->open(), every), every, most_rows);
        if (!logs.empty()) return logs;
    }
    const std::size_t joints = open_log(spool->open(), every)->layout().all_chosen().size();
    for (std::size_t j = 0; j < joints; ++j) {
        auto pieces = read_pieces(spool, every, most_rows, j);
        if (!pieces) return read_all_joints(*open_log(spool->open(), every), every);
        logs.push_back(std::move(*pieces));
    }
    return logs;
}

Log read_log(std::unique_ptr<ByteSource> source, const ReadOptions& options) {
    const auto reader = open_log(std::move(source), options);
    return read_log(*reader, options);
}

Log read_log(const std::string& path, const ReadOptions& options) {
    return read_log(std::make_unique<ByteSource>(path), options);
}

std::optional<Log> read_log_if_short(const Spool& log, const ReadOptions& options, std::size_t most_rows) {
    const auto reader = open_log(log.open(), options);
    std::vector<Log> logs = read_all_joints(*reader, options, most_rows);
    if (logs.empty()) return std::nullopt;
    return std::move(logs.front());
}

std::vector<Log> read_each_if_short(const Spool& log, const ReadOptions& options, std::size_t most_rows) {
    if (!options.columns.empty() || options.hold_bad_values) return {};
    ReadOptions each = options;
    each.each_joint = true;
    const auto reader = open_log(log.open(), each);
    const std::size_t joints = reader->layout().each.size();
    if (joints < 2) return {};
    return read_all_joints(*reader, options, most_rows / joints);
}

AskedJoints asked_joints(const Spool& log, ReadOptions options) {
    options.needs_torque = false;
    options.constant_speed.reset();  // of the motor it needs a gear ratio, which the names do not
    const auto reader = open_log(log.open(), options);
    return {reader->layout().asked, reader->layout().left_out};
}

Log read_log_in_part(const std::string& path, const ReadOptions& options, std::size_t most_rows) {
    return in_part(std::make_shared<const Spool>(path), options, most_rows);
}

std::vector<Log> read_joints_in_part(const std::string& path, const ReadOptions& options,
                                     std::size_t most_rows) {
    const auto spool = std::make_shared<const Spool>(path);
    const AskedJoints joints = asked_joints(*spool, options);
    std::vector<Log> logs;
    if (joints.names.size() < 2 && (joints.left_out.empty() || !options.joint)) {
        logs.push_back(in_part(spool, options, most_rows));
        return logs;
    }
    const std::size_t each = most_rows == all_rows ? all_rows : most_rows * joints.names.size();
    logs = read_each_if_short(*spool, options, each);
    ReadOptions one = options;
    for (std::size_t j = logs.size(); j < joints.names.size(); ++j) {
        one.joint = joints.names[j];
        logs.push_back(in_part(spool, one, most_rows));
    }
    for (Log& log : logs) log.layout.left_out = joints.left_out;
    return logs;
}

}  // namespace ripplenotch
