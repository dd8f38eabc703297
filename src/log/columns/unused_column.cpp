// SPDX-License-Identifier: MIT
// Why a column or a joint of a log is not read, as `info -v` and warnings say it.

#include <fmt/format.h>

#include <algorithm>

#include "log/columns/column_name.hpp"
#include "log/columns/units.hpp"
#include "ripplenotch/core/quantity.hpp"

namespace ripplenotch {

std::string what_is_missing(const JointGroup& joint) {
    if (!joint.has(Role::torque)) return "it has no torque";
    return joint.has(Role::position) ? "it has no velocity" : "it has neither velocity nor position";
}

namespace {

bool holds(const JointGroup& joint, Role role, std::size_t column) {
    const auto found = joint.candidates.find(role);
    return found != joint.candidates.end() &&
           std::find(found->second.begin(), found->second.end(), column) != found->second.end();
}

}  // namespace

std::string why_unused(const KnownColumns& known, std::size_t column, const std::vector<JointGroup>& joints,
                       const std::vector<JointGroup>& incomplete) {
    const ColumnName& name = known.names[column];
    if (known.forced.roles[column]) return "skipped by --columns";
    if (known.facts.names.empty()) return "it has no name";
    const std::string_view role = role_name(name.role);
    if (name.role == Role::other)
        return name.symbol == Role::other
                   ? "its name is none of a time, velocity, torque or position"
                   : fmt::format("it may be a {} or something else", role_name(name.symbol));
    if (name.reference) return fmt::format("a {} that is a wish or a model, not measured", role);
    if (!name.unit.empty() && !usual_unit(name.unit, name.role))
        return fmt::format("a {} in '{}', which is no unit that is read", role, name.unit);
    if (name.role == Role::time) return "another column is the time";
    if (known.forced.column_of(name.role)) return fmt::format("--columns names the {}", role);
    for (const JointGroup& joint : incomplete)
        if (holds(joint, name.role, column))
            return fmt::format("the {} of {}: {}", role,
                               joint.name.empty() ? "a joint without name" : joint.name,
                               what_is_missing(joint));
    const bool rivalled = std::any_of(joints.begin(), joints.end(), [&](const JointGroup& joint) {
        return holds(joint, name.role, column) && joint.candidates.at(name.role).size() > 1;
    });
    return rivalled ? fmt::format("another column is the {} by its name", role)
                    : fmt::format("a {} of no joint that is read", role);
}

}  // namespace ripplenotch
