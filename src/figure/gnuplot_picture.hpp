// SPDX-License-Identifier: MIT
#pragma once
#include <string>
#include <vector>

#include "ripplenotch/figure/figure.hpp"

namespace ripplenotch {

// Where everything in a picture goes, in pixels from the top left, so that nothing overlaps or is cut: space
// for names is set aside from their lengths before anything is drawn.

inline constexpr double letter_px = 7.3;  ///< a little more than the mean of the widest usual sans at 12 px

inline constexpr double small_letter_px = 6.6;  ///< at 11 px

inline constexpr double line_px = 17.0;

/// A named line's label: on top (written upward) or at the right of the panel.
struct LineLabel {
    std::size_t line = 0;  ///< index into Panel::lines
    std::string text;      ///< cut to fit
    bool on_top = false;
    double anchor_px = 0.0;  ///< where the line meets the edge: x on top, y at the right
    double at_px = 0.0;      ///< where the label stands, pushed off its neighbours
};

struct PanelLayout {
    double left = 0.0, right = 0.0, top = 0.0, bottom = 0.0;  ///< edges of the axes' box
    double title_y = 0.0;
    double legend_x = 0.0, legend_y = 0.0;
    int legend_rows = 0;  ///< 0: no legend
    PlotRange x, y;
    std::vector<LineLabel> labels;
};

struct PictureLayout {
    double width = 0.0, height = 0.0;
    std::vector<std::string> title, sentence;  ///< lines
    std::vector<PanelLayout> panels;
};

/// Names that the legend shows, in its order: ribbons, then curves.
[[nodiscard]] std::vector<std::string> legend_names(const Panel& panel);

[[nodiscard]] PictureLayout lay_out(const Figure& figure);

/// Positions at least `apart` from each other between `from` and `to` as far as they fit, in the order of
/// `wanted`'s values and close to them.
[[nodiscard]] std::vector<double> pushed_apart(const std::vector<double>& wanted, double apart, double from,
                                               double to);

/// Removes gnuplot's version and its empty groups; escapes "]]>" in a text, which gnuplot does not, to make
/// it valid XML.
[[nodiscard]] std::string same_svg(std::string svg);

/// With the clock and the library's version, which cairo writes into every document, replaced by as many
/// other characters: a PDF counts its bytes.
[[nodiscard]] std::string same_pdf(std::string pdf);

}  // namespace ripplenotch
