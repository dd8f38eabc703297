// SPDX-License-Identifier: MIT
// Figures in characters: gnuplot's dumb terminal draws the axes and curves, names and lists go below as text.

#include <algorithm>
#include <cmath>

#include "figure/gnuplot_picture.hpp"
#include "figure/gnuplot_script.hpp"
#include "ripplenotch/core/visible_text.hpp"
#include "ripplenotch/figure/gnuplot.hpp"
#include "ripplenotch/figure/min_max.hpp"

namespace ripplenotch {
namespace {

constexpr int rows_of_panel = 20;
constexpr double plot_rows = rows_of_panel - 4.0;
constexpr std::string_view curve_characters = "*#$%@&=";  // of gnuplot's line types 1, 2, ...
constexpr std::string_view level_characters = " .:-=+*%@";
constexpr std::string_view letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZ";
constexpr std::size_t left_columns = 11;  // for the numbers of the y axis

std::string without_blank_ends(const std::string& text) {
    std::string result, line;
    const auto close = [&] {
        const std::size_t last = line.find_last_not_of(" \f\r");
        line.resize(last == std::string::npos ? 0 : last + 1);
        if (!line.empty()) result += line + "\n";
        line.clear();
    };
    for (const char c : text) {
        if (c == '\n') {
            close();
        } else if (c != '\f') {
            line += c;
        }
    }
    close();
    return result;
}

// One panel as gnuplot draws it.
class TextPanel {
  public:
    TextPanel(const Panel& panel, int columns)
        : panel_(panel), columns_(columns), x_(x_range(panel)), y_(y_range(panel)) {}

    [[nodiscard]] std::optional<std::string> draw() {
        script_.line("set encoding utf8\nset terminal dumb noenhanced size {},{}", columns_, rows_of_panel);
        script_.line(
            "set lmargin {}\nset rmargin 3\nset tmargin 1\nset bmargin 2\nset border 3\nset tics nomirror",
            left_columns);
        script_.line("unset key");
        axis("x", panel_.x, x_);
        axis("y", panel_.y, y_);
        std::vector<std::string> parts;
        if (panel_.map) {
            const HeatMap raster =
                rasterised(*panel_.map, x_, panel_.x.scale, y_, panel_.y.scale,
                           {.columns = static_cast<std::size_t>(columns_) - left_columns - 4,
                            .rows = static_cast<std::size_t>(rows_of_panel) - 4});
            parts.push_back(script_.cells(raster, level_characters) + " using 1:2:3 with labels");
        }
        for (std::size_t i = 0; i < panel_.curves.size(); ++i) draw(panel_.curves[i], i, parts);
        mark_lines();
        std::string all;
        for (const std::string& part : parts) all += (all.empty() ? "" : ", ") + part;
        script_.line("plot {}", all.empty() ? "NaN" : all);
        const auto drawn = run_gnuplot(script_.text());
        if (!drawn) return std::nullopt;
        return heading() + without_blank_ends(*drawn) + below();
    }

  private:
    void axis(const char* name, const PlotAxis& axis, const PlotRange& range) {
        script_.line("set {0}range [{1:.10g}:{2:.10g}]\nset format {0} '%.5g'", name, range.from, range.to);
        if (axis.scale == PlotScale::logarithmic) script_.line("set logscale {}", name);
        if (const std::string ticks = gnuplot_ticks(range, axis.scale); !ticks.empty())
            script_.line("set {}tics {}", name, ticks);
    }

    void draw(const Curve& whole, std::size_t i, std::vector<std::string>& parts) {
        const Curve curve = thinned(whole, static_cast<std::size_t>(columns_));
        const std::string data = script_.rows({&curve.x, &curve.y});
        const std::size_t type = i % curve_characters.size() + 1;
        if (curve.style == CurveStyle::points || curve.style == CurveStyle::crosses) {
            // A point is the character of its curve, which "with points" would not give.
            parts.push_back(
                fmt::format("{} using 1:2:(\"{}\") with labels", data, curve_characters[type - 1]));
            return;
        }
        const char* how = curve.style == CurveStyle::steps   ? "steps"
                          : curve.style == CurveStyle::stems ? "impulses"
                                                             : "lines";
        parts.push_back(fmt::format("{} using 1:2 with {} lt {}", data, how, type));
    }

    // A letter where each line leaves the panel, none on top of another; rays and levels are dotted on the
    // way.
    void mark_lines() {
        std::vector<std::size_t> above, beside;
        std::vector<double> columns, rows;
        for (const NamedLine& line : panel_.lines) {
            Segment s{};
            if (named_.size() == letters.size() || !segment_of(line, x_, y_, s)) continue;
            const bool on_top = line.run == NamedLine::Run::at_x;
            (on_top ? above : beside).push_back(named_.size());
            if (on_top) {
                columns.push_back(plot_columns() * share_along(x_, panel_.x.scale, s.x1));
            } else {
                rows.push_back(plot_rows * share_along(y_, panel_.y.scale, s.y1));
                // Dots only where nothing else is drawn that they would hide.
                if (!panel_.map) dots(s);
            }
            named_.push_back(&line);
        }
        columns = pushed_apart(columns, 2.0, 0.0, plot_columns());
        rows = pushed_apart(rows, 1.0, 0.0, plot_rows);
        for (std::size_t i = 0; i < above.size(); ++i)
            script_.line("set label \"{}\" at graph {:.6g},1 center front", letters[above[i]],
                         columns[i] / plot_columns());
        for (std::size_t i = 0; i < beside.size(); ++i)
            script_.line("set label \"{}\" at graph 1,{:.6g} offset 1,0 center front", letters[beside[i]],
                         rows[i] / plot_rows);
    }

    [[nodiscard]] double plot_columns() const { return static_cast<double>(columns_) - left_columns - 4.0; }

    void dots(const Segment& s) {
        const int count = columns_ / 3;
        for (int i = 1; i < count; ++i) {
            const double share = static_cast<double>(i) / count;
            script_.line("set label \".\" at {:.10g},{:.10g} center back", s.x0 + share * (s.x1 - s.x0),
                         s.y0 + share * (s.y1 - s.y0));
        }
    }

    [[nodiscard]] std::string lines_of(const std::string& words) const {
        std::string text;
        for (const std::string& line : wrapped(words, static_cast<std::size_t>(columns_)))
            text += line + "\n";
        return text;
    }

    [[nodiscard]] std::string heading() const {
        std::string text;
        if (!panel_.title.empty()) text += lines_of(visible_text(panel_.title));
        return text + lines_of(visible_text(axis_text(panel_.y)));
    }

    // The x axis' label, then what the characters and the letters mean.
    [[nodiscard]] std::string below() const {
        const std::string label =
            cut_to(visible_text(axis_text(panel_.x)), static_cast<std::size_t>(columns_) - 4);
        const std::size_t width = text_width(label), room = static_cast<std::size_t>(columns_) - 4;
        std::string text = std::string(width < room ? room - width : 0, ' ') + label + "\n";
        if (panel_.map) {
            const HeatMap& map = *panel_.map;
            text += lines_of(fmt::format("{}: '.' from {:.3g}, '@' at {:.3g}",
                                         visible_text(axis_text({map.label, map.unit})),
                                         value_at({map.lowest, map.highest}, map.scale,
                                                  1.0 / static_cast<double>(level_characters.size())),
                                         map.highest));
        }
        for (std::size_t i = 0; i < panel_.curves.size(); ++i) {
            if (panel_.curves[i].name.empty()) continue;
            text += lines_of(fmt::format("  {} {}", curve_characters[i % curve_characters.size()],
                                         visible_text(panel_.curves[i].name)));
        }
        for (std::size_t i = 0; i < named_.size(); ++i)
            text += lines_of(fmt::format("  {} {}", letters[i], visible_text(named_[i]->name)));
        return text;
    }

    const Panel& panel_;
    int columns_;
    PlotRange x_, y_;
    GnuplotScript script_;
    std::vector<const NamedLine*> named_;
};

}  // namespace

std::optional<std::string> draw_text(const Figure& figure, int columns) {
    check_figure(figure);
    const int width = std::clamp(columns, 40, 200);
    std::string text;
    for (const std::string* words : {&figure.title, &figure.sentence}) {
        if (words->empty()) continue;
        for (const std::string& line : wrapped(visible_text(*words), static_cast<std::size_t>(width)))
            text += line + "\n";
    }
    for (const Panel& panel : figure.panels) {
        const auto drawn = TextPanel(panel, width).draw();
        if (!drawn) return std::nullopt;
        text += "\n" + *drawn;
    }
    return text;
}

}  // namespace ripplenotch
