// SPDX-License-Identifier: MIT
// Whole logs in memory, with their time base examined.

#include <memory>

#include "log/plausibility.hpp"
#include "log/unwrap.hpp"
#include "ripplenotch/log/log.hpp"

namespace ripplenotch {
namespace {

void append(std::vector<double>& to, const std::vector<double>& from) {
    to.insert(to.end(), from.begin(), from.end());
}

Log read_rows(LogReader& reader, const ReadOptions& options) {
    Log log;
    RowBlock block;
    while (reader.next(block)) {
        append(log.trace.time_s, block.time_s);
        const JointRows& joint = block.joints.front();
        append(log.trace.velocity_deg_s, joint.velocity_deg_s);
        append(log.trace.torque_nm, joint.torque_nm);
        append(log.trace.position_deg, joint.position_deg);
        log.held_bad_values += block.held_bad_values;
    }
    log.layout = reader.layout();
    log.trace.source = log.layout.source;
    log.trace.joint = log.layout.chosen.joint;
    const auto period = wrap_period(log.trace.position_deg);
    if (period) Unwrapper(*period).apply(log.trace.position_deg);
    log.timebase = examine_timebase(log.trace.view());
    if (log.layout.stated_rate) log.timebase.sample_rate = *log.layout.stated_rate;
    log.trace.sample_rate = log.timebase.sample_rate;
    const LogExtremes extremes = extremes_of(log.trace.view());
    require_rate(log.layout, extremes, options);
    for (std::string& warning : doubts(log.layout, period, extremes))
        log.layout.warnings.push_back(std::move(warning));
    return log;
}

std::unique_ptr<ByteSource> source_of(const std::string& path,
                                      const std::shared_ptr<const std::string>& bytes) {
    if (bytes) return std::make_unique<ByteSource>("standard input", bytes);
    return std::make_unique<ByteSource>(path);
}

}  // namespace

Log read_log(std::unique_ptr<ByteSource> source, const ReadOptions& options) {
    const auto reader = open_log(std::move(source), options);
    return read_rows(*reader, options);
}

Log read_log(const std::string& path, const ReadOptions& options) {
    return read_log(std::make_unique<ByteSource>(path), options);
}

std::vector<Log> read_joints(const std::string& path, const ReadOptions& options) {
    // A pipe can be read once only, so it is kept; a file is read again for each joint.
    std::shared_ptr<const std::string> bytes;
    if (path == "-") bytes = std::make_shared<const std::string>(read_all(path));
    ReadOptions survey = options;
    survey.joint.reset();
    survey.needs_torque = false;
    const std::vector<std::string> joints = open_log(source_of(path, bytes), survey)->layout().joints;
    std::vector<Log> logs;
    ReadOptions one = options;
    for (const std::string& joint : joints) {
        one.joint = joint.empty() ? std::nullopt : std::optional<std::string>(joint);
        logs.push_back(read_log(source_of(path, bytes), one));
    }
    if (logs.empty()) {
        one.joint.reset();
        logs.push_back(read_log(source_of(path, bytes), one));
    }
    return logs;
}

}  // namespace ripplenotch
