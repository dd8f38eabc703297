// SPDX-License-Identifier: MIT
#include "ripplenotch/figure/figure_kinds.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

namespace ripplenotch {
namespace {

constexpr FigureKind list[] = {
#define FIGURE(name, command) {name, command},
#include "figure/figures.def"
#undef FIGURE
};

}  // namespace

std::span<const FigureKind> figure_kinds() { return list; }

std::string figures_of(std::string_view command) {
    std::string names;
    for (const FigureKind& kind : list) {
        if (kind.command == command) names += fmt::format("{}{}", names.empty() ? "" : ", ", kind.name);
    }
    return names;
}

void require_listed_figure(std::string_view name) {
    const auto same = [name](const FigureKind& kind) { return kind.name == name; };
    if (std::none_of(std::begin(list), std::end(list), same))
        throw std::logic_error(fmt::format("figure {} has no line in src/figure/figures.def", name));
}

}  // namespace ripplenotch
