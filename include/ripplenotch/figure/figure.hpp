// SPDX-License-Identifier: MIT
#pragma once
// A figure as a value: what it shows, in which units, under which names. Built once from results (module
// chart); renderers draw it, document writes it as JSON. Nothing here depends on pixels.

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace ripplenotch {

// Which figures there are: one line each in src/figure/figures.def. Help, docs/figures and tests follow it.

struct FigureKind {
    std::string_view name;     ///< Figure::name
    std::string_view command;  ///< the command that draws it with --plot
};

/// "campbell, order-map": those of one command.
[[nodiscard]] std::string figures_of(std::string_view command);
/// Throws std::logic_error, which names the list, where no figure has this name.
void require_listed_figure(std::string_view name);

/// `whole`: linear, of things that are counted; numbers stand at whole values alone.
enum class PlotScale { linear, logarithmic, whole };

/// An axis with its quantity and unit. A logarithmic axis omits values that are not above 0.
struct PlotAxis {
    std::string label, unit = {};  ///< "torque", "Nm"; a number without a unit has none
    PlotScale scale = PlotScale::linear;
    std::optional<double> from = {}, to = {};  ///< left out: the range of the panel's contents
};

/// Eight colours that are distinguishable with colour blindness (Okabe and Ito 2002). The number is the index
/// in ink_rgb.
enum class Ink { black, blue, vermilion, green, orange, purple, sky, grey };
/// "#0072b2"
[[nodiscard]] std::string ink_rgb(Ink ink);
/// The i-th of the inks that distinguish series; starts again after six.
[[nodiscard]] Ink series_ink(std::size_t i);

enum class CurveStyle { line, dashed, steps, points, stems, crosses };
/// The other mark of the same kind, for a curve whose ink another has: dashes for a line, crosses for points.
[[nodiscard]] CurveStyle other_mark(CurveStyle style);
/// `style` for the i-th series: from the seventh on the inks begin again, with the other mark.
[[nodiscard]] CurveStyle series_style(std::size_t i, CurveStyle style);

/// The ink of an order, the same in every figure: that of its whole number, 1 blue, 2 vermilion, 3 green,
/// 4 orange, 5 purple, 6 sky. Broken orders and those above 6 share these inks with the other mark.
[[nodiscard]] Ink order_ink(double order);
[[nodiscard]] CurveStyle order_style(double order, CurveStyle style);
/// A tone does not turn with the motor: it is black, with the other mark. An unknown line is grey.
inline constexpr Ink tone_ink = Ink::black, unknown_ink = Ink::grey;

/// Points of equal length x and y, joined in this order; a nan breaks the line.
struct Curve {
    std::string name;  ///< in the legend; empty: not there
    Ink ink = Ink::blue;
    CurveStyle style = CurveStyle::line;
    std::vector<double> x, y;
};

/// The area between two curves over the same x: an interval, a spread.
struct Ribbon {
    std::string name;
    Ink ink = Ink::grey;
    std::vector<double> x, low, high;
};

/// A rectangle behind the curves: a band of speeds, a stretch of time. Edges may be infinite: to the panel's
/// edge.
struct Shade {
    std::string name;  ///< written in it when it fits
    Ink ink = Ink::grey;
    double x_from = 0.0, x_to = 0.0, y_from = 0.0, y_to = 0.0;
};

/// A straight line with a name of its own next to the panel: a peak, an order, a fit.
struct NamedLine {
    enum class Run {
        at_x,  ///< x = value
        at_y,  ///< y = value
        ray,   ///< y = value * x
    };
    std::string name;
    Run run = Run::at_x;
    double value = 0.0;
    Ink ink = Ink::grey;
    bool dashed = true;
};

/// cells[row * (x_edges.size() - 1) + column]; edges rise, nan is an empty cell.
struct HeatMap {
    std::string label, unit = {};  ///< label of the cells
    PlotScale scale = PlotScale::linear;
    double lowest = 0.0, highest = 1.0;  ///< range of the colours; cells beyond take the colour of the end
    std::vector<double> x_edges = {}, y_edges = {}, cells = {};
};

/// One pair of axes.
struct Panel {
    std::string title;
    PlotAxis x, y;
    std::optional<HeatMap> map = {};
    std::vector<Shade> shades = {};
    std::vector<Ribbon> ribbons = {};
    std::vector<Curve> curves = {};
    std::vector<NamedLine> lines = {};
    bool legend = true;   ///< false where a neighbouring panel has the same names
    double height = 1.0;  ///< against that of other panels
};

struct Figure {
    std::string name;      ///< kebab-case, which figure this is: "spectrum", "candidate-table"
    std::string title;     ///< what is shown, from which file
    std::string sentence;  ///< the main observation, with numbers; may be empty
    std::vector<Panel> panels;
    int columns = 1;  ///< panels run left to right, then down
};

/// From the lowest to the highest; empty when nothing can be shown.
struct PlotRange {
    double from = 0.0, to = 1.0;
};
/// The range of an axis of the panel: as stated, else that of the contents, a little wider along y.
[[nodiscard]] PlotRange x_range(const Panel& panel);
[[nodiscard]] PlotRange y_range(const Panel& panel);
/// Distance of the numbers along an axis of PlotScale::whole, at most twelve of them: 1, 2, 5, 10, 20, ...
[[nodiscard]] double whole_step(const PlotRange& range);
/// 0 at range.from, 1 at range.to; may lie outside. nan for values that a logarithmic axis cannot show.
[[nodiscard]] double share_along(const PlotRange& range, PlotScale scale, double value);
/// The inverse of share_along.
[[nodiscard]] double value_at(const PlotRange& range, PlotScale scale, double share);

/// "torque, Nm"
[[nodiscard]] std::string axis_text(const PlotAxis& axis);

/// Throws std::logic_error when vectors that belong together differ in length: a fault of the builder.
void check_figure(const Figure& figure);

// Draws figures with gnuplot, a child process that gets its script through a pipe and gives the picture back
// through another; it sees no file name and no text that it could run.

enum class PictureKind { svg, png, pdf };

/// The bytes of a picture, the same each time: no clock, no version. Empty when gnuplot is not installed;
/// throws FileError with gnuplot's own message when it fails.
[[nodiscard]] std::optional<std::string> draw_picture(const Figure& figure, PictureKind kind);

/// The figure in characters, lines of at most `columns` (40 to 200), one panel under the other. As above.
[[nodiscard]] std::optional<std::string> draw_text(const Figure& figure, int columns);

}  // namespace ripplenotch
