// SPDX-License-Identifier: MIT
#include "log/columns/stated_units.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "log/columns/unit_text.hpp"
#include "ripplenotch/core/error.hpp"

namespace ripplenotch::layout_detail {
namespace {

// One sentence for all units that nobody stated.
void say_assumed_units(Layout& layout, const ColumnFacts& facts) {
    std::vector<std::string> taken, asked;
    std::vector<std::optional<std::size_t>> columns = {layout.chosen.time};
    for (const JointColumns& joint : layout.all_chosen())
        columns.insert(columns.end(), {joint.velocity, joint.torque, joint.position});
    for (const auto& column : columns) {
        if (!column || !layout.columns[*column].unit_assumed) continue;
        const Column& c = layout.columns[*column];
        taken.push_back(fmt::format("{} as {}", column_label(facts.names, *column), c.unit));
        asked.push_back(fmt::format("--unit {}={}", role_name(c.role), c.unit));
    }
    for (const JointColumns& joint : layout.all_chosen()) {
        if (!joint.torque || !layout.columns[*joint.torque].unit_assumed) continue;
        const Column& torque = layout.columns[*joint.torque];
        layout.assumptions.push_back({fmt::format("unit of {}", column_label(facts.names, *joint.torque)),
                                      torque.unit,
                                      "nothing in the log says it",
                                      fmt::format("--unit torque={}", torque.unit),
                                      {}});
    }
    if (!taken.empty()) {
        layout.warnings.push_back({"assumed units",
                                   fmt::format("no unit is stated for what is read: took {}; {} settles it",
                                               fmt::join(taken, ", "), fmt::join(asked, " ")),
                                   true});
    }
}

void say_torque_constant(Layout& layout, const ColumnFacts& facts, const ReadOptions& options) {
    const auto torque = layout.chosen.torque;
    if (!torque) return;
    const bool current = is_current_unit(layout.columns[*torque].unit);
    if (current && !options.nm_per_ampere) {
        layout.warnings.push_back(
            {"motor current",
             fmt::format("{} is a motor current: 1 A is taken as 1 Nm, so every torque is in "
                         "amperes; --kt gives the joint's torque constant in Nm/A",
                         column_label(facts.names, *torque)),
             true});
    }
    if (!current && options.nm_per_ampere) {
        layout.warnings.push_back(
            {"--kt",
             fmt::format("--kt has no effect: {} is in {}", column_label(facts.names, *torque),
                         layout.columns[*torque].unit),
             true});
    }
}

void require_used_unit(const Layout& layout, const std::string& key) {
    for (const Role role : {Role::time, Role::velocity, Role::torque, Role::position}) {
        if (key == role_name(role)) return;
    }
    for (const Column& column : layout.columns) {
        if (column.name == key) return;
    }
    raise<UsageError>("--unit: '{}' is neither a role (time, velocity, torque, position) nor a column of {}",
                      key, layout.source);
}

}  // namespace

std::optional<std::string> asked_unit(const ReadOptions& options, const std::string& name, Role role) {
    for (const std::string& key : {name, std::string(role_name(role))}) {
        if (const auto found = options.units.find(key); found != options.units.end()) return found->second;
    }
    return std::nullopt;
}

std::string unit_list(Role role) {
    std::string list = fmt::format("{}", fmt::join(unit_names(dimension_of(role)), ", "));
    return role == Role::torque ? list + ", A, mA" : list;
}

void state_units(Layout& layout, const ColumnFacts& facts, const ReadOptions& options) {
    say_assumed_units(layout, facts);
    for (const auto& [key, unit] : options.units) require_used_unit(layout, key);
    say_torque_constant(layout, facts, options);
}

void state_derived_velocity(Layout& layout, const ColumnFacts& facts) {
    if (!layout.chosen.time && !layout.stated_rate) return;
    for (const JointColumns& joint : layout.all_chosen()) {
        if (joint.velocity || !joint.position) continue;
        const std::string label = column_label(facts.names, *joint.position);
        layout.velocity_from_position = true;
        layout.warnings.push_back(
            {"derived velocity",
             fmt::format(
                 "no velocity is logged: it is the slope of {}, from row to row; --columns velocity=NAME "
                 "decides otherwise",
                 label),
             true});
        layout.inferences.push_back({"velocity",
                                     fmt::format("the slope of {}", label),
                                     "no column is a velocity",
                                     "--columns velocity=NAME",
                                     {}});
    }
}

}  // namespace ripplenotch::layout_detail
