// SPDX-License-Identifier: MIT
#pragma once
// Units and sides of velocity and position where the log does not state them: from names, from how far the
// position goes in the time of the velocity, and from what a joint can do. The one place that decides.

#include <optional>
#include <string>
#include <vector>

#include "log/columns/conventions.hpp"
#include "log/columns/decide_layout.hpp"
#include "log/columns/joint_groups.hpp"

namespace ripplenotch::layout_detail {

/// What is known of a velocity or position column before its values are looked at.
struct MotionColumn {
    std::size_t column = 0;
    bool unit_is_stated = false;
    bool named_motor = false;
    const Convention* convention = nullptr;
    std::optional<Shaft> stated_side;
};

/// The motion of one joint; one of the two may be missing.
struct MotionColumns {
    std::string joint;
    std::optional<MotionColumn> velocity, position;
    bool chosen = false;
};

/// Of the joints that are read, and of the file's others whose columns nobody has to choose between.
[[nodiscard]] std::vector<MotionColumns> motions_of(const KnownColumns& known,
                                                    const std::vector<JointGroup>& groups,
                                                    const std::vector<bool>& unit_is_stated,
                                                    const ReadOptions& options, const Layout& layout);

/// Sets unit, factor and side of the velocity and position columns of all `joints` alike, and says in
/// `layout` what was inferred, what stays assumed, and which other readings are as possible.
void infer_motion(const ColumnFacts& facts, const ReadOptions& options,
                  const std::vector<MotionColumns>& joints, Layout& layout);

}  // namespace ripplenotch::layout_detail
