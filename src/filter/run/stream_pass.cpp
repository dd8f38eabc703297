// SPDX-License-Identifier: MIT
#include "filter/run/stream_pass.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace ripplenotch {

StreamPass::StreamPass(Account& account, std::span<const JointRun> joints) : account_(account) {
    for (const JointRun& run : joints) lanes_.push_back({run});
}

void StreamPass::filter(const RowBlock& block, std::vector<std::vector<double>>& torque_nm) {
    torque_nm.resize(lanes_.size());
    const std::span<const RunPart> parts = account_.add(block);
    for (std::size_t j = 0; j < lanes_.size(); ++j) {
        Lane& lane = lanes_[j];
        note_motion(block.joints[j], lane);
        torque_nm[j].resize(block.size());
        const auto warmth = lane.run.temperature != nullptr ? lane.run.temperature->next(block.size())
                                                            : std::span<const double>{};
        for (const RunPart& part : parts) filter_part(block, j, part, warmth, torque_nm[j]);
        lane.rows += block.size();
        lane.report.held_bad_values += block.held_bad_values;
    }
}

void StreamPass::filter_part(const RowBlock& block, std::size_t joint, const RunPart& part,
                             std::span<const double> temperature_degc, std::vector<double>& torque_nm) {
    Lane& lane = lanes_[joint];
    TraceView rows = view_of(block, joint, part.first, part.count);
    const std::span<double> out = std::span(torque_nm).subspan(part.first, part.count);
    if (!part.usable) {
        std::copy(rows.torque_nm.begin(), rows.torque_nm.end(), out.begin());
        lane.rows_left_out += part.count;
        return;
    }
    rows.position_deg = lane.position.of(account_.angle(joint), rows);
    if (part.begins_run && lane.rows + part.first > lane.rows_left_out) lane.run.filter->restart();
    const auto warmth =
        temperature_degc.empty() ? temperature_degc : temperature_degc.subspan(part.first, part.count);
    lane.run.filter->process({rows.velocity_deg_s, rows.torque_nm, rows.position_deg, warmth}, out);
    note_switches(block, lane);
    if (lane.run.meter != nullptr) meter_rows(rows, part.begins_run, out, lane);
}

void StreamPass::meter_rows(const TraceView& rows, bool begins_run, std::span<const double> torque_nm,
                            Lane& lane) {
    RippleMeter& meter = *lane.run.meter;
    if (begins_run) meter.split();
    for (std::size_t k = 0; k < rows.size(); ++k) {
        const double* const position = rows.has_position() ? &rows.position_deg[k] : nullptr;
        const std::array torque = {rows.torque_nm[k], torque_nm[k]};
        meter.add(Seconds(rows.time_s[k]), rows.velocity_deg_s[k], position, torque);
    }
}

// A filter counts the rows it was given; people count those of the log.
void StreamPass::note_switches(const RowBlock& block, Lane& lane) {
    const auto switches = lane.run.filter->switches();
    std::vector<TimedSwitch>& listed = lane.report.switches;
    for (std::size_t i = listed.size(); i < switches.size(); ++i) {
        Switch change = switches[i];
        change.sample += lane.rows_left_out;
        listed.push_back({change, block.time_s[change.sample - lane.rows]});
    }
}

void StreamPass::note_motion(const JointRows& rows, Lane& lane) {
    StreamReport& report = lane.report;
    SpeedExtent range{report.slowest_deg_s, report.fastest_deg_s};
    if (lane.rows == 0 && !rows.velocity_deg_s.empty())
        range.slowest_deg_s = range.fastest_deg_s = std::abs(rows.velocity_deg_s.front());
    widen(range, rows.velocity_deg_s);
    report.slowest_deg_s = range.slowest_deg_s;
    report.fastest_deg_s = range.fastest_deg_s;
}

std::vector<StreamReport> StreamPass::reports(const Layout& layout) const {
    std::vector<StreamReport> reports;
    for (std::size_t j = 0; j < lanes_.size(); ++j) {
        StreamReport report = lanes_[j].report;
        report.recording = account_.recording(layout, j);
        report.switch_count = lanes_[j].run.filter->switch_count();
        reports.push_back(std::move(report));
    }
    return reports;
}

}  // namespace ripplenotch
