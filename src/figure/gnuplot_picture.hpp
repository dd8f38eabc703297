// SPDX-License-Identifier: MIT
#pragma once

#include <fmt/format.h>

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "ripplenotch/figure/figure.hpp"

namespace ripplenotch {

// Where everything in a picture goes, in pixels from the top left, so that nothing overlaps or is cut: space
// for names is set aside from their lengths before anything is drawn.

inline constexpr double letter_px = 7.3;  ///< a little more than the mean of the widest usual sans at 12 px

inline constexpr double small_letter_px = 6.6;  ///< at 11 px

inline constexpr double line_px = 17.0;

[[nodiscard]] double text_px(std::string_view text, double letter = letter_px);

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

// Elements common to every gnuplot script. Text goes in as octal numbers of its bytes, so that none of it can
// be a quote, a back quote, a macro or a command; numbers go in as numbers.

/// Runs gnuplot without user settings on this script and returns its output; empty when there is no gnuplot.
/// Throws FileError when it ends with another exit code than 0.
[[nodiscard]] std::optional<std::string> run_gnuplot(const std::string& script);

/// visible_text(text) as a string constant of gnuplot, quotes included.
[[nodiscard]] std::string gnuplot_string(std::string_view text);

class GnuplotScript {
  public:
    template <class... Args>
    void line(fmt::format_string<Args...> format, Args&&... args) {
        fmt::format_to(std::back_inserter(text_), format, std::forward<Args>(args)...);
        text_ += '\n';
    }
    /// Range, scale and numbers of the axis of this name, "x".
    void axis(std::string_view name, const PlotAxis& axis, const PlotRange& range);
    void plot(const std::vector<std::string>& parts);
    /// A block of rows; returns its name. A row with a nan becomes an empty row, which breaks a line.
    std::string rows(const std::vector<const std::vector<double>*>& columns);
    /// A block of text cells: x, y, one character.
    std::string cells(const HeatMap& map, std::string_view levels);
    /// A block for `matrix`: one row of numbers a row of the map, within the range of its colours.
    std::string matrix(const HeatMap& map);

    [[nodiscard]] const std::string& text() const { return text_; }

  private:
    std::string open_block();
    std::string text_;
    int blocks_ = 0;
};

/// "(0.1, 0.2, 0.5, 1)" for a logarithmic axis of few decades, where powers of ten alone would be one or two
/// numbers; the step of one that counts; empty for others.
[[nodiscard]] std::string gnuplot_ticks(const PlotRange& range, PlotScale scale);

/// A cell within the range of the map's colours; nan stays.
[[nodiscard]] double within_colours(const HeatMap& map, double value);

/// The straight line of `line` through a panel with these ranges; empty when it does not pass through it.
struct Segment {
    double x0, y0, x1, y1;
    bool on_top;  ///< it leaves the panel at its upper edge, else at the right
};
[[nodiscard]] std::optional<Segment> segment_of(const NamedLine& line, const PlotRange& x,
                                                const PlotRange& y);

}  // namespace ripplenotch
