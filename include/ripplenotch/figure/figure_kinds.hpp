// SPDX-License-Identifier: MIT
#pragma once
// Which figures there are: one line each in src/figure/figures.def. Help, docs/figures and tests follow it.

#include <span>
#include <string>
#include <string_view>

namespace ripplenotch {

struct FigureKind {
    std::string_view name;     ///< Figure::name
    std::string_view command;  ///< that draws it with --plot
};

/// All figures, in the order of figures.def.
[[nodiscard]] std::span<const FigureKind> figure_kinds();
/// "campbell, order-map": those of one command.
[[nodiscard]] std::string figures_of(std::string_view command);
/// Throws std::logic_error, which names the list, where no figure has this name.
void require_listed_figure(std::string_view name);

}  // namespace ripplenotch
