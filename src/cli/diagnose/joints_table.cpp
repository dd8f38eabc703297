// SPDX-License-Identifier: MIT
#include "cli/diagnose/joints_table.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "cli/talk.hpp"

namespace ripplenotch {
namespace {

std::string nm(const std::optional<double>& value) { return value ? fmt::format("{:.4g}", *value) : "-"; }

}  // namespace

std::string joints_table(const std::vector<JointDiagnosis>& joints) {
    const bool validated = std::any_of(joints.begin(), joints.end(), [](const JointDiagnosis& one) {
        return one.diagnosis.gap.validation_before_nm.has_value();
    });
    std::vector<std::vector<std::string>> cells = {{"joint", "before, Nm", "after, Nm"}};
    if (validated) cells.front().insert(cells.front().end(), {"validation before", "validation after"});
    cells.front().insert(cells.front().end(), {"verdict", "named"});
    for (const JointDiagnosis& one : joints) {
        const Diagnosis& row = one.diagnosis;
        auto& line = cells.emplace_back(std::vector{one.joint, nm(row.gap.before_nm), nm(row.gap.after_nm)});
        if (validated)
            line.insert(line.end(), {nm(row.gap.validation_before_nm), nm(row.gap.validation_after_nm)});
        line.emplace_back(verdict_name(row.verdict));
        line.push_back(row.named.empty() ? "nothing" : fmt::format("{}", fmt::join(row.named, ", ")));
    }
    return text_table(cells, validated ? "lrrrrll" : "lrrll");
}

}  // namespace ripplenotch
