// SPDX-License-Identifier: MIT
#include "ripplenotch/export/target.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "export/targets.hpp"
#include "ripplenotch/core/error.hpp"

namespace ripplenotch {
namespace {
constexpr const Target* every_target[] = {
#define TARGET(name) &targets::name,
#include "export/targets/targets.def"
#undef TARGET
};
}  // namespace

std::span<const Target* const> export_targets() { return every_target; }

std::vector<std::string_view> targets_that(bool Target::*trait, bool value) {
    std::vector<std::string_view> names;
    for (const Target* target : export_targets()) {
        if (target->*trait == value) names.push_back(target->name);
    }
    return names;
}

const Target& find_target(std::string_view name) {
    std::vector<std::string> known;
    for (const Target* target : export_targets()) {
        if (target->name == name) return *target;
        known.emplace_back(target->name);
    }
    const auto near = nearest_name(name, known);
    raise<UsageError>("there is no export target '{}'{}; targets: {}", name,
                      near ? fmt::format(" (did you mean {}?)", *near) : "", fmt::join(known, ", "));
}

}  // namespace ripplenotch
