// SPDX-License-Identifier: MIT
// Whole logs in memory, with an account of them.

#include <algorithm>
#include <memory>

#include "log/account/account.hpp"
#include "log/account/unwrap.hpp"
#include "log/clock/clock_check.hpp"
#include "log/pieces.hpp"
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

// The position as it was logged has been looked at; from here on it is the joint's, or there is none. One
// that is not, or runs the other way, is held against the clock as it was logged.
void settle_angle(Log& log) {
    JointsPosition joints;
    const auto found = joints.of(log.recording.angle, log.trace.view());
    std::vector<double> position(found.begin(), found.end());
    const bool as_logged = position.empty() || log.recording.angle.verdict == AngleFacts::Verdict::reversed;
    if (!as_logged) log.trace.position_deg = position;
    MotionPieces motion(log.trace.size());
    motion.add(log.trace.view());
    const ClockCheck check = motion.check(log.trace.sample_rate);
    log.clock_factor = check.factor;
    log.recording.warnings = recording_warnings(log.recording, check.warning);
    if (as_logged) log.trace.position_deg = std::move(position);
}

// What is known when all rows are there.
void finish(Log& log, const Account& account, const LogReader& reader, std::size_t joint) {
    const Layout& layout = reader.layout();
    const JointColumns chosen = layout.all_chosen()[joint];
    log.layout = layout;
    log.trace.source = layout.source;
    log.trace.joint = chosen.joint;
    const auto period = wrap_period(log.trace.position_deg);
    if (period) Unwrapper(*period).apply(log.trace.position_deg);
    log.recording = account.recording(layout, joint);
    log.layout.chosen = chosen;
    log.layout.others.clear();
    log.trace.sample_rate = log.recording.clock.mean_rate;
    if (!log.trace.position_deg.empty()) {
        const auto [low, high] =
            std::minmax_element(log.trace.position_deg.begin(), log.trace.position_deg.end());
        log.position_range_deg.emplace(*low, *high);
    }
    if (period) log.layout.warnings.push_back({"wrapped position", wrap_in_words(*period), true});
    settle_angle(log);
}

// Empty where there are more than `most_rows`.
std::vector<Log> read_all_joints(LogReader& reader, const ReadOptions& options, std::size_t most_rows) {
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

std::vector<Log> read_all_joints(LogReader& reader, const ReadOptions& options) {
    return read_all_joints(reader, options, all_rows);
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

Log read_log(LogReader& reader, const ReadOptions& options) {
    return std::move(read_all_joints(reader, options).front());
}

std::vector<Log> read_joints_at_once(const std::string& path, const ReadOptions& options) {
    ReadOptions every = options;
    every.joint.reset();
    every.every_joint = true;
    return read_all_joints(*open_log(path, every), every);
}

std::vector<Log> read_joints_at_once_in_part(const std::string& path, const ReadOptions& options,
                                             std::size_t most_rows) {
    const auto spool = std::make_shared<const Spool>(path);
    ReadOptions every = options;
    every.joint.reset();
    every.every_joint = true;
    std::vector<Log> logs;
    if (!looks_longer(*spool, every, most_rows)) {
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

std::vector<std::string> joint_names(const Spool& log, ReadOptions options) {
    options.joint.reset();
    options.needs_torque = false;
    return open_log(log.open(), options)->layout().joints;
}

Log read_log_in_part(const std::string& path, const ReadOptions& options, std::size_t most_rows) {
    return in_part(std::make_shared<const Spool>(path), options, most_rows);
}

std::vector<Log> read_joints_in_part(const std::string& path, const ReadOptions& options,
                                     std::size_t most_rows) {
    const auto spool = std::make_shared<const Spool>(path);
    std::vector<Log> logs;
    ReadOptions one = options;
    for (const std::string& joint : joint_names(*spool, options)) {
        one.joint = joint.empty() ? std::nullopt : std::optional<std::string>(joint);
        logs.push_back(in_part(spool, one, most_rows));
    }
    if (!logs.empty()) return logs;
    one.joint.reset();
    logs.push_back(in_part(spool, one, most_rows));
    return logs;
}

}  // namespace ripplenotch
