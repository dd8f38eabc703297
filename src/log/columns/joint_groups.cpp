// SPDX-License-Identifier: MIT
#include "log/columns/joint_groups.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "ripplenotch/core/error.hpp"

namespace ripplenotch::layout_detail {
namespace {

// Columns named one by one belong to a named joint only when their names agree on it.
std::string joint_of_forced(const KnownColumns& known) {
    const auto torque = known.forced.column_of(Role::torque);
    auto motion = known.forced.column_of(Role::velocity);
    if (!motion) motion = known.forced.column_of(Role::position);
    if (known.forced.by_place || !torque || !motion) return "";
    const std::string& joint = known.names[*torque].joint;
    return joint_key(joint) == joint_key(known.names[*motion].joint) ? joint : "";
}

// Torque and motion are named by --columns: the other columns of these roles tell nothing, nor do joints that
// have nothing else.
void drop_unasked(const KnownColumns& known, bool joint_asked, std::vector<JointGroup>& groups) {
    const auto& forced = known.forced;
    const auto torque = forced.column_of(Role::torque);
    const bool moves = forced.column_of(Role::velocity) || forced.column_of(Role::position);
    if (forced.by_place || !torque || !moves) return;
    const std::string of_torque = joint_key(known.names[*torque].joint);
    const auto is_unasked = [&](const JointGroup& group) {
        return group.key != of_torque &&
               std::all_of(motion_roles.begin(), motion_roles.end(),
                           [&](Role role) { return forced.column_of(role) || !group.has(role); });
    };
    if (joint_asked && std::all_of(groups.begin(), groups.end(), is_unasked) &&
        !joint_of_forced(known).empty())
        groups.clear();
    if (joint_asked) return;
    groups.erase(std::remove_if(groups.begin(), groups.end(), is_unasked), groups.end());
    const bool told = std::any_of(groups.begin(), groups.end(),
                                  [&](const JointGroup& group) { return group.key == of_torque; });
    if (groups.size() > 1 && !told) groups.clear();
}

std::vector<JointGroup> collect_groups(const KnownColumns& known, bool merge) {
    std::vector<JointGroup> groups;
    for (const bool reference : {false, true}) {
        for (std::size_t c = 0; c < known.facts.columns; ++c) {
            const ColumnName& name = known.names[c];
            if (known.forced.roles[c] || name.reference != reference) continue;
            if (name.role == Role::other || name.role == Role::time) continue;
            const std::string key = merge ? "" : joint_key(name.joint);
            auto group =
                std::find_if(groups.begin(), groups.end(), [&](const JointGroup& g) { return g.key == key; });
            if (group == groups.end()) {
                if (reference && !groups.empty()) continue;  // a wish alone does not make a joint
                groups.push_back({key, merge ? "" : name.joint, {}});
                group = groups.end() - 1;
            }
            group->candidates[name.role].push_back(c);
        }
    }
    return groups;
}

[[noreturn]] void refuse_tie(const KnownColumns& known, Role role, const std::vector<std::size_t>& best) {
    std::vector<std::string> labels, choices;
    for (const std::size_t c : best) {
        labels.push_back(column_label(known.facts.names, c));
        const bool repeated =
            std::count(known.facts.names.begin(), known.facts.names.end(), known.facts.names[c]) > 1;
        choices.push_back(fmt::format("--columns {}={}", role_name(role),
                                      repeated ? std::to_string(c + 1) : known.facts.names[c]));
    }
    raise<DataError>("{}: {} could each be the {}; say {}", known.source, fmt::join(labels, " and "),
                     role_name(role), fmt::join(choices, " or "));
}

}  // namespace

std::vector<JointGroup> group_joints(const KnownColumns& known, bool joint_asked, bool needs_torque) {
    std::vector<JointGroup> groups = collect_groups(known, false);
    drop_unasked(known, joint_asked, groups);
    const auto complete = [&](const JointGroup& group) {
        const auto has = [&](Role role) { return group.has(role) || known.forced.column_of(role); };
        return (has(Role::torque) || !needs_torque) && (has(Role::velocity) || has(Role::position));
    };
    if (groups.empty() && (known.forced.column_of(Role::torque) || known.forced.column_of(Role::velocity))) {
        const std::string joint = joint_of_forced(known);
        groups.push_back({joint_key(joint), joint, {}});
    }
    if (std::none_of(groups.begin(), groups.end(), complete) && groups.size() > 1 && !joint_asked) {
        // "motor_torque" beside "link_velocity": one joint whose columns are named after different
        // things.
        std::array<std::size_t, 3> counts{};
        for (std::size_t r = 0; r < motion_roles.size(); ++r) {
            for (const JointGroup& group : groups) counts[r] += group.has(motion_roles[r]);
        }
        if (std::all_of(counts.begin(), counts.end(), [](std::size_t n) { return n <= 1; })) {
            groups = collect_groups(known, true);
        }
    }
    const bool any_complete = std::any_of(groups.begin(), groups.end(), complete);
    if (any_complete) {
        groups.erase(
            std::remove_if(groups.begin(), groups.end(), [&](const JointGroup& g) { return !complete(g); }),
            groups.end());
    }
    return groups;
}

std::optional<std::size_t> choose_column(const KnownColumns& known, const JointGroup& group, Role role,
                                         std::vector<LogWarning>& warnings) {
    if (const auto forced = known.forced.column_of(role)) return forced;
    const auto found = group.candidates.find(role);
    if (found == group.candidates.end()) return std::nullopt;
    const auto cost = [&known](std::size_t c) {
        return known.names[c].rank + (known.names[c].reference ? 100 : 0);
    };
    int lowest = 1000;
    for (const std::size_t c : found->second) lowest = std::min(lowest, cost(c));
    std::vector<std::size_t> best, still;
    for (const std::size_t c : found->second) {
        if (cost(c) != lowest) continue;
        const bool moves = known.facts.sample.empty() || varies(known.facts.sample[c]);
        (moves ? best : still).push_back(c);
    }
    if (best.empty()) best.swap(still);
    if (best.size() > 1) refuse_tie(known, role, best);
    if (!still.empty()) {
        warnings.push_back(
            {"standing column",
             fmt::format("{} does not change at the start of the log; the {} is taken from {}; --columns "
                         "{}=NAME decides otherwise",
                         column_label(known.facts.names, still.front()), role_name(role),
                         column_label(known.facts.names, best.front()), role_name(role)),
             true});
    }
    if (known.names[best.front()].reference) {
        warnings.push_back({"reference",
                            fmt::format("{} is a wish or a model, not a measurement, and the only {} here",
                                        column_label(known.facts.names, best.front()), role_name(role)),
                            true});
    }
    return best.front();
}

}  // namespace ripplenotch::layout_detail
