// SPDX-License-Identifier: MIT
#include "cli/joint_keys.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>

#include "ripplenotch/artifact/identification.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"

namespace ripplenotch {
namespace {

bool given(const Spec& spec, std::string_view key) {
    return std::any_of(spec.values.begin(), spec.values.end(),
                       [key](const auto& entry) { return entry.first == key; });
}

void fill(Spec& spec, const Method& method, std::string_view key, std::string value) {
    if (has_key(method, key) && !given(spec, key)) spec.values.emplace_back(key, std::move(value));
}

std::string list_text(const std::vector<double>& values) {
    std::vector<std::string> texts;
    for (const double value : values) texts.push_back(shortest(value));
    return fmt::format("{}", fmt::join(texts, ":"));
}

struct JointLines {
    std::vector<double> orders, amplitude_nm, phase_deg;
    bool phases_known = true;
};

// The strongest line of each order, lowest order first.
JointLines lines_of(const Identification& found) {
    std::map<double, const Line*> by_order;
    for (const Line& line : found.lines) {
        if (line.kind != LineKind::order || !line.order) continue;
        const Line*& entry = by_order[*line.order];
        if (entry == nullptr || line.amplitude_nm > entry->amplitude_nm) entry = &line;
    }
    JointLines lines;
    for (const auto& [order, line] : by_order) {
        lines.orders.push_back(order);
        lines.amplitude_nm.push_back(line->amplitude_nm);
        lines.phase_deg.push_back(line->phase_deg);
        lines.phases_known = lines.phases_known && line->phase_known;
    }
    return lines;
}

}  // namespace

bool has_key(const Method& method, std::string_view key) {
    return std::any_of(method.keys.begin(), method.keys.end(),
                       [key](const Key& entry) { return entry.name == key; });
}

void fill_from_options(Spec& spec, const Method& method, const GearOptions& gear) {
    if (gear.gear_ratio) fill(spec, method, "gear-ratio", shortest(*gear.gear_ratio));
    if (!gear.orders.empty()) fill(spec, method, "orders", list_text(gear.orders));
    if (gear.joint_file) fill(spec, method, "joint", *gear.joint_file);
}

std::string spell_out_joint(Spec& spec, const Method& method) {
    if (!has_key(method, "joint")) return "";
    const auto entry = std::find_if(spec.values.begin(), spec.values.end(),
                                    [](const auto& value) { return value.first == "joint"; });
    if (entry == spec.values.end()) return "";
    const std::string path = entry->second;
    if (path.empty()) raise<UsageError>("method {}, joint: the value is empty", method.name);
    spec.values.erase(entry);
    const Identification found = load_identification(path);
    if (!found.gear_ratio.value && !given(spec, "gear-ratio")) {
        raise<DataError>("{}: its gear ratio is null, because identify found none; give gear-ratio=...",
                         path);
    }
    const JointLines lines = lines_of(found);
    if (lines.orders.empty() && !given(spec, "orders")) {
        raise<DataError>("{}: it has no line that follows the motor; give orders=...", path);
    }
    // Amplitudes and phases belong to the file's own orders.
    const bool own_orders = !given(spec, "orders");
    if (found.gear_ratio.value) fill(spec, method, "gear-ratio", shortest(*found.gear_ratio.value));
    fill(spec, method, "orders", list_text(lines.orders));
    if (own_orders) {
        fill(spec, method, "amplitudes", list_text(lines.amplitude_nm));
        if (lines.phases_known) fill(spec, method, "phases", list_text(lines.phase_deg));
    }
    return path;
}

}  // namespace ripplenotch
