// SPDX-License-Identifier: MIT
// Which columns of a file are a joint's motion, and what is known of their units before any value is looked
// at.

#include <algorithm>

#include "log/columns/infer_motion.hpp"

namespace ripplenotch::layout_detail {
namespace {

// The measured column for a role where nobody has to choose between several.
std::optional<std::size_t> only_column(const KnownColumns& known, const JointGroup& group, Role role) {
    const auto found = group.candidates.find(role);
    if (found == group.candidates.end()) return std::nullopt;
    std::optional<std::size_t> only;
    for (const std::size_t c : found->second) {
        if (known.names[c].reference) continue;
        if (only) return std::nullopt;
        only = c;
    }
    return only;
}

}  // namespace

std::vector<MotionColumns> motions_of(const KnownColumns& known, const std::vector<JointGroup>& groups,
                                      const std::vector<bool>& unit_is_stated, const ReadOptions& options,
                                      const Layout& layout) {
    const auto column = [&](std::optional<std::size_t> c, Role role) -> std::optional<MotionColumn> {
        if (!c || layout.columns[*c].role != role) return std::nullopt;
        const auto side = options.sides.find(role);
        const auto& names = known.facts.meanings();
        return MotionColumn{*c, unit_is_stated[*c], known.names[*c].motor_side,
                            names.empty() ? nullptr : convention_of(names[*c], role, names),
                            side == options.sides.end() ? std::nullopt : std::optional<Shaft>(side->second)};
    };
    std::vector<MotionColumns> motions;
    const auto add = [&](const std::string& joint, std::optional<std::size_t> velocity,
                         std::optional<std::size_t> position, bool chosen) {
        MotionColumns motion{joint, column(velocity, Role::velocity), column(position, Role::position),
                             chosen};
        if (motion.velocity || motion.position) motions.push_back(motion);
    };
    const std::vector<JointColumns> all = layout.all_chosen();
    for (const JointColumns& joint : all) add(joint.joint, joint.velocity, joint.position, true);
    for (const JointGroup& group : groups) {
        const bool chosen = std::any_of(all.begin(), all.end(),
                                        [&](const JointColumns& joint) { return joint.joint == group.name; });
        if (!chosen)
            add(group.name, only_column(known, group, Role::velocity),
                only_column(known, group, Role::position), false);
    }
    return motions;
}

}  // namespace ripplenotch::layout_detail
