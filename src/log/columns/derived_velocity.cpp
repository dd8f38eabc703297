// SPDX-License-Identifier: MIT
#include "log/columns/derived_velocity.hpp"

#include <cmath>
#include <utility>

namespace ripplenotch {

DerivedVelocity::DerivedVelocity(std::unique_ptr<LogReader> reader) : reader_(std::move(reader)) {
    const Layout& read = reader_->layout();
    const std::vector<JointColumns> joints = read.all_chosen();
    for (std::size_t j = 0; j < joints.size(); ++j) {
        if (joints[j].velocity || !joints[j].position) continue;
        joints_.push_back(j);
        turns_deg_.push_back(360.0 / read.columns[*joints[j].position].motor_ratio.value_or(1.0));
    }
    before_.resize(joints_.size());
}

// What is wrong in the block ahead must not keep the rows before it from being passed on.
void DerivedVelocity::look_ahead() {
    try {
        do {
            more_ = reader_->next(ahead_);
        } while (more_ && ahead_.size() == 0 && ahead_.bytes.empty());
    } catch (...) {
        failure_ = std::current_exception();
        ahead_.clear();
        more_ = false;
    }
}

bool DerivedVelocity::next(RowBlock& block) {
    if (!std::exchange(begun_, true)) look_ahead();
    if (!more_) {
        if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
        return false;
    }
    std::swap(block, ahead_);
    look_ahead();
    for (std::size_t k = 0; k < joints_.size(); ++k) derive(block, k);
    return true;
}

void DerivedVelocity::derive(RowBlock& block, std::size_t k) {
    JointRows& rows = block.joints[joints_[k]];
    const std::size_t size = block.size();
    if (size == 0) return;
    const auto point = [](const RowBlock& from, std::size_t joint, std::size_t row) {
        return Point{from.time_s[row], from.joints[joint].position_deg[row]};
    };
    const double turn = turns_deg_[k];
    double slope = 0.0;
    for (std::size_t i = 0; i < size; ++i) {
        const Point here = point(block, joints_[k], i);
        const Point first = i > 0 ? point(block, joints_[k], i - 1) : before_[k].value_or(here);
        const bool another = more_ && ahead_.size() > 0;
        const Point last = i + 1 < size ? point(block, joints_[k], i + 1)
                           : another    ? point(ahead_, joints_[k], 0)
                                        : here;
        const double passed = last.time_s - first.time_s;
        double moved = last.position_deg - first.position_deg;
        moved -= turn * std::round(moved / turn);
        if (passed > 0.0) slope = moved / passed;
        rows.velocity_deg_s[i] = slope;
    }
    before_[k] = point(block, joints_[k], size - 1);
}

bool ConstantVelocity::next(RowBlock& block) {
    if (!reader_->next(block)) return false;
    for (JointRows& rows : block.joints) rows.velocity_deg_s.assign(block.size(), speed_.value());
    return true;
}

}  // namespace ripplenotch
