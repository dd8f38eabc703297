// SPDX-License-Identifier: MIT
#include "log/account/account.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace ripplenotch {
namespace {

bool has_values(const std::vector<double>& values) {
    return !values.empty() && std::isfinite(values.front());
}

}  // namespace

TraceView view_of(const RowBlock& block, std::size_t joint, std::size_t first, std::size_t count) {
    const JointRows& rows = block.joints[joint];
    const auto part = [&](const std::vector<double>& values) {
        return values.empty() ? std::span<const double>{} : std::span(values).subspan(first, count);
    };
    return {{}, part(block.time_s), part(rows.velocity_deg_s), part(rows.torque_nm), part(rows.position_deg)};
}

Account::Account(const Layout& layout, const Opening& opening, double gap_steps)
    : clock_(layout.source, opening.time_s, layout.stated_rate, gap_steps) {
    const std::size_t joints = opening.blocks.empty() ? 1 : opening.blocks.front().joints.size();
    for (std::size_t j = 0; j < joints; ++j) {
        const JointRows* const rows = opening.blocks.empty() ? nullptr : &opening.blocks.front().joints[j];
        const bool velocity = rows != nullptr && has_values(rows->velocity_deg_s);
        const bool position = rows != nullptr && has_values(rows->position_deg);
        joints_.push_back({{}, {velocity && !layout.velocity_from_position, position}});
    }
    judged_ = clock_.facts().refusal.empty();
    Clock clock = clock_;
    for (std::size_t b = 0; b < opening.blocks.size(); ++b) {
        const RowBlock& block = opening.blocks[b];
        for (const RunPart& part : clock.add(std::span(block.time_s).first(opening.counts[b]))) {
            for (std::size_t j = 0; j < joints_.size() && part.usable && judged_; ++j)
                joints_[j].angle.look(view_of(block, j, part.first, part.count), part.begins_run);
        }
    }
    for (Joint& joint : joints_) joint.angle.decide();
}

std::span<const RunPart> Account::add(const RowBlock& block) {
    const std::span<const RunPart> parts = clock_.add(block.time_s);
    for (const RunPart& part : parts) {
        for (std::size_t j = 0; j < joints_.size(); ++j) {
            const TraceView rows = view_of(block, j, part.first, part.count);
            if (part.usable) joints_[j].held.count(rows, part.begins_run);
            if (part.usable && judged_)
                joints_[j].angle.follow(rows, part.begins_run);
            else
                joints_[j].angle.skip(part.count);
        }
    }
    return parts;
}

Recording Account::recording(const Layout& layout, std::size_t joint) const {
    Recording recording;
    recording.source = layout.source;
    recording.joint = layout.all_chosen()[joint].joint;
    recording.clock = clock_.facts();
    recording.held = joints_[joint].held.held();
    recording.angle = joints_[joint].angle.facts();
    recording.assumptions = layout.assumptions;
    recording.inferences = layout.inferences;
    if (layout.outside) recording.outside = *layout.outside;
    recording.warnings = recording_warnings(recording);
    return recording;
}

std::span<const double> JointsPosition::of(const AngleFacts& angle, const TraceView& rows) {
    const std::size_t first = std::exchange(rows_, rows_ + rows.size());
    if (angle.source() == AngleFacts::Source::velocity || !rows.has_position()) return {};
    const std::size_t parting = std::min(angle.contradicted ? angle.contradicted->used_row : rows_, rows_);
    const bool reversed = angle.verdict == AngleFacts::Verdict::reversed;
    if (!reversed && parting == rows_) {
        last_deg_ = rows.position_deg.back();
    } else {
        room_.resize(rows.size());
        for (std::size_t k = 0; k < rows.size(); ++k) {
            const double speed =
                0.5 * (rows.velocity_deg_s[k] + (k > 0 ? rows.velocity_deg_s[k - 1] : last_deg_s_));
            const double step = rows.time_s[k] - (k > 0 ? rows.time_s[k - 1] : last_s_);
            if (first + k < parting)
                last_deg_ = reversed ? -rows.position_deg[k] : rows.position_deg[k];
            else
                last_deg_ += speed * step;
            room_[k] = last_deg_;
        }
    }
    last_s_ = rows.time_s.back();
    last_deg_s_ = rows.velocity_deg_s.back();
    return !reversed && parting == rows_ ? rows.position_deg : room_;
}

}  // namespace ripplenotch
