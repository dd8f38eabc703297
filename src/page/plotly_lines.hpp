// SPDX-License-Identifier: MIT
#pragma once
// The named lines of a panel in a plotly figure: where a line leaves the panel its name stands, and names
// that would lie on each other are pushed apart.

#include <string>

#include "document/json/json.hpp"
#include "figure/gnuplot_script.hpp"
#include "figure/picture_layout.hpp"
#include "ripplenotch/figure/figure.hpp"

namespace ripplenotch {

inline constexpr double plot_px = 780.0;   ///< a page's width less the margins; narrower screens scale it
inline constexpr double panel_px = 240.0;  ///< height of a panel of height 1

class PlotlyLines {
  public:
    /// `suffix` of the panel's axes: empty, "2", "3", ...
    PlotlyLines(const Panel& panel, std::string suffix);

    /// Space for the names above the panel, or right of it.
    [[nodiscard]] double names_px(bool on_top) const;
    /// Adds shapes and annotations.
    void write(Json& layout) const;

  private:
    [[nodiscard]] bool leaves_on_top(const NamedLine& line, const Segment& s) const;
    void draw(Json& layout, const NamedLine& line, const Segment& s) const;
    void label(Json& layout, const NamedLine& line, const Segment& s, bool on_top, double push_px) const;

    const Panel& panel_;
    std::string suffix_;
    PlotRange x_, y_;
};

}  // namespace ripplenotch
