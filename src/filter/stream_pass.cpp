// SPDX-License-Identifier: MIT
#include "filter/stream_pass.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "filter/kernels/first_outside.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"

namespace ripplenotch {

StreamPass::StreamPass(std::string source, double gap_s, std::span<const JointRun> joints,
                       const std::vector<double>& moving_deg_s)
    : source_(std::move(source)), gap_s_(gap_s) {
    for (std::size_t j = 0; j < joints.size(); ++j)
        lanes_.push_back({joints[j], HeldRows(moving_deg_s[j]), {}});
}

// Accounts for a step that is not simply one sample on. True when it is a gap.
bool StreamPass::step_is_gap(const RowBlock& block, std::size_t k, double step_s) {
    if (step_s < 0.0) {
        raise<DataError>(
            "{}: data row {}: time runs backward, from {} s to {} s; put the rows in order, or count the "
            "rows at a stated rate with --sample-rate",
            source_, block.first_row + k + 1, shortest(last_time_s_), shortest(block.time_s[k]));
    }
    if (step_s > gap_s_) {
        if (clock_.gaps.size() < most_listed_gaps)
            clock_.gaps.push_back({block.first_row + k - 1, last_time_s_, block.time_s[k]});
        ++clock_.gap_count;
        return true;
    }
    if (step_s == 0.0) ++clock_.repeated_times;
    return false;
}

void StreamPass::find_stretches(const RowBlock& block) {
    stretches_.assign(1, {});
    const std::span<const double> time_s = block.time_s;
    for (std::size_t k = 0; k < time_s.size(); k += first_step_outside(time_s.subspan(k), 0.0, gap_s_)) {
        if (k > 0) last_time_s_ = time_s[k - 1];
        const double step_s = time_s[k] - last_time_s_;
        const bool first_of_all = clock_.rows + k == 0;
        const bool usual = step_s > 0.0 && step_s <= gap_s_;
        if (first_of_all || (!usual && step_is_gap(block, k, step_s))) {
            if (!first_of_all) duration_s_ += last_time_s_ - run_begin_s_;
            run_begin_s_ = time_s[k];
            stretches_.back().count = k - stretches_.back().first;
            if (k > 0)
                stretches_.push_back({k, 0, true});
            else
                stretches_.back().begins_run = true;
        }
    }
    if (!time_s.empty()) last_time_s_ = time_s.back();
    stretches_.back().count = time_s.size() - stretches_.back().first;
}

void StreamPass::take(const RowBlock& block, std::vector<std::vector<double>>& torque_nm) {
    torque_nm.resize(lanes_.size());
    find_stretches(block);
    for (std::size_t j = 0; j < lanes_.size(); ++j) {
        note_motion(block.joints[j], lanes_[j], stretches_);
        filter_lane(block, block.joints[j], lanes_[j], torque_nm[j]);
    }
    clock_.rows += block.size();
}

void StreamPass::filter_lane(const RowBlock& block, const JointRows& rows, Lane& lane,
                             std::vector<double>& torque_nm) const {
    torque_nm.resize(block.size());
    for (const Stretch& stretch : stretches_) {
        const auto part = [&stretch](const std::vector<double>& values) {
            return values.empty() ? std::span<const double>{}
                                  : std::span(values).subspan(stretch.first, stretch.count);
        };
        const bool after_gap = stretch.begins_run && clock_.rows + stretch.first > 0;
        if (after_gap) lane.run.filter->restart();
        lane.run.filter->process({part(rows.velocity_deg_s), part(rows.torque_nm), part(rows.position_deg)},
                                 std::span(torque_nm).subspan(stretch.first, stretch.count));
        if (lane.run.meter == nullptr) continue;
        if (after_gap) lane.run.meter->split();
        meter_rows(rows, stretch, *lane.run.meter, torque_nm);
    }
    const auto switches = lane.run.filter->switches();
    std::vector<TimedSwitch>& listed = lane.report.switches;
    for (std::size_t i = listed.size(); i < switches.size(); ++i)
        listed.push_back({switches[i], block.time_s[switches[i].sample - clock_.rows]});
    lane.report.held_bad_values += block.held_bad_values;
}

void StreamPass::meter_rows(const JointRows& rows, const Stretch& stretch, RippleMeter& meter,
                            const std::vector<double>& torque_nm) {
    for (std::size_t k = stretch.first; k < stretch.first + stretch.count; ++k) {
        const double* position = rows.position_deg.empty() ? nullptr : &rows.position_deg[k];
        const std::array torque = {rows.torque_nm[k], torque_nm[k]};
        meter.add(rows.velocity_deg_s[k], position, torque);
    }
}

void StreamPass::note_motion(const JointRows& rows, Lane& lane, const std::vector<Stretch>& stretches) {
    SpeedRange range{lane.report.slowest_deg_s, lane.report.fastest_deg_s};
    if (lane.report.rows == 0 && !rows.velocity_deg_s.empty())
        range.slowest_deg_s = range.fastest_deg_s = std::abs(rows.velocity_deg_s.front());
    widen(range, rows.velocity_deg_s);
    for (const Stretch& stretch : stretches)
        lane.held.add(rows, stretch.first, stretch.first + stretch.count, !stretch.begins_run);
    lane.report.slowest_deg_s = range.slowest_deg_s;
    lane.report.fastest_deg_s = range.fastest_deg_s;
    lane.report.rows += rows.velocity_deg_s.size();
}

std::vector<StreamReport> StreamPass::reports() {
    const double duration_s = duration_s_ + (last_time_s_ - run_begin_s_);
    const std::size_t runs = 1 + clock_.gap_count;
    if (clock_.rows > runs && duration_s > 0.0)
        clock_.measured_rate = Hertz(static_cast<double>(clock_.rows - runs) / duration_s);
    std::vector<StreamReport> reports;
    for (Lane& lane : lanes_) {
        StreamReport& report = lane.report;
        report.measured_rate = clock_.measured_rate;
        report.gaps = clock_.gaps;
        report.gap_count = clock_.gap_count;
        report.repeated_times = clock_.repeated_times;
        report.held_samples = lane.held.count();
        report.switch_count = lane.run.filter->switch_count();
        reports.push_back(std::move(report));
    }
    return reports;
}

}  // namespace ripplenotch
