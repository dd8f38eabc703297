// SPDX-License-Identifier: MIT
// Pictures: SVG, PNG and PDF from one script.

#include "figure/gnuplot_picture.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <string_view>
#include <vector>

#include "ripplenotch/core/visible_text.hpp"
#include "ripplenotch/figure/figure.hpp"
#include "ripplenotch/figure/min_max.hpp"

namespace ripplenotch {

namespace {

constexpr double left_px = 84.0;  ///< left margin of a panel, for the numbers and the name of its y axis

constexpr double page_width = 900.0, wide_page_width = 1160.0;
constexpr double right_px = 22.0, box_height = 250.0, below_px = 50.0, colours_px = 96.0;
constexpr double label_apart_px = 15.0;
constexpr std::size_t longest_label = 32;

struct Frame {
    double left, top, width, beside;  ///< beside: kept free at the right, the same in all panels
};

// Labels of the lines that pass through the panel, not yet placed.
std::vector<LineLabel> labels_of(const Panel& panel, const PlotRange& x, const PlotRange& y) {
    std::vector<LineLabel> labels;
    for (std::size_t i = 0; i < panel.lines.size(); ++i) {
        const NamedLine& line = panel.lines[i];
        const auto segment = segment_of(line, x, y);
        if (line.name.empty() || !segment) continue;
        labels.push_back({i, cut_to(visible_text(line.name), longest_label), segment->on_top, 0.0, 0.0});
    }
    return labels;
}

double longest_px(const std::vector<LineLabel>& labels, bool on_top) {
    double longest = 0.0;
    for (const LineLabel& label : labels)
        if (label.on_top == on_top) longest = std::max(longest, text_px(label.text, small_letter_px));
    return longest;
}

void place(std::vector<LineLabel>& labels, const Panel& panel, const PanelLayout& box, bool on_top) {
    std::vector<std::size_t> mine;
    std::vector<double> wanted;
    for (std::size_t i = 0; i < labels.size(); ++i) {
        if (labels[i].on_top != on_top) continue;
        const Segment segment = *segment_of(panel.lines[labels[i].line], box.x, box.y);
        const double share = on_top ? share_along(box.x, panel.x.scale, segment.x1)
                                    : share_along(box.y, panel.y.scale, segment.y1);
        labels[i].anchor_px =
            on_top ? box.left + share * (box.right - box.left) : box.bottom - share * (box.bottom - box.top);
        mine.push_back(i);
        wanted.push_back(labels[i].anchor_px);
    }
    const auto placed = on_top ? pushed_apart(wanted, label_apart_px, box.left, box.right)
                               : pushed_apart(wanted, label_apart_px, box.top, box.bottom);
    for (std::size_t k = 0; k < mine.size(); ++k) labels[mine[k]].at_px = placed[k];
}

// The margin of the widest panel, so that the axes of panels one below the other line up.
double needed_beside(const Figure& figure) {
    double most = 0.0;
    for (const Panel& panel : figure.panels) {
        const double names = longest_px(labels_of(panel, x_range(panel), y_range(panel)), false);
        most = std::max(most, (names > 0.0 ? names + 18.0 : 0.0) + (panel.map ? colours_px : 0.0));
    }
    return most;
}

// Height of the panel's part of the page is returned through `bottom`.
PanelLayout lay_out_panel(const Panel& panel, const Frame& frame, double& bottom) {
    PanelLayout box;
    box.x = x_range(panel);
    box.y = y_range(panel);
    box.labels = labels_of(panel, box.x, box.y);
    const double above = longest_px(box.labels, true);
    box.left = frame.left + left_px;
    box.right = frame.left + frame.width - right_px - frame.beside;
    double y = frame.top;
    if (!panel.title.empty()) {
        box.title_y = y + 0.7 * line_px;
        y += 1.3 * line_px;
    }
    box.top = y + (above > 0.0 ? above + 24.0 : 8.0);
    box.bottom = box.top + box_height * panel.height;
    y = box.bottom + below_px;
    const std::vector<std::string> names = legend_names(panel);
    if (!names.empty() && panel.legend) {
        double longest = 0.0;
        for (const std::string& name : names) longest = std::max(longest, text_px(name) + 60.0);
        const int across = std::max(1, std::min(3, static_cast<int>((frame.width - 20.0) / longest)));
        box.legend_rows = (static_cast<int>(names.size()) + across - 1) / across;
        box.legend_x = frame.left + 14.0;
        box.legend_y = y;
        y += line_px * box.legend_rows + 6.0;
    }
    place(box.labels, panel, box, true);
    place(box.labels, panel, box, false);
    bottom = y + 8.0;
    return box;
}

}  // namespace

double text_px(std::string_view text, double letter) {
    return letter * static_cast<double>(text_width(text));
}

std::vector<std::string> legend_names(const Panel& panel) {
    std::vector<std::string> names;
    for (const Ribbon& ribbon : panel.ribbons)
        if (!ribbon.name.empty()) names.push_back(visible_text(ribbon.name));
    for (const Curve& curve : panel.curves)
        if (!curve.name.empty()) names.push_back(visible_text(curve.name));
    return names;
}

PictureLayout lay_out(const Figure& figure) {
    PictureLayout page;
    page.width = figure.columns > 1 ? wide_page_width : page_width;
    page.title = wrapped(visible_text(figure.title), static_cast<std::size_t>((page.width - 28.0) / 9.0));
    if (!figure.sentence.empty()) {
        page.sentence =
            wrapped(visible_text(figure.sentence), static_cast<std::size_t>((page.width - 28.0) / letter_px));
    }
    double y = 14.0 + 20.0 * static_cast<double>(page.title.size()) +
               line_px * static_cast<double>(page.sentence.size()) + 6.0;
    const auto columns = static_cast<std::size_t>(figure.columns);
    const double width = page.width / static_cast<double>(columns), beside = needed_beside(figure);
    for (std::size_t first = 0; first < figure.panels.size(); first += columns) {
        double row_bottom = y;
        for (std::size_t i = first; i < std::min(first + columns, figure.panels.size()); ++i) {
            double bottom = 0.0;
            page.panels.push_back(lay_out_panel(
                figure.panels[i], {width * static_cast<double>(i - first), y, width, beside}, bottom));
            row_bottom = std::max(row_bottom, bottom);
        }
        y = row_bottom;
    }
    page.height = std::ceil(y + 4.0);
    return page;
}

std::vector<double> pushed_apart(const std::vector<double>& wanted, double apart, double from, double to) {
    std::vector<std::size_t> order(wanted.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return wanted[a] < wanted[b]; });
    const std::size_t n = wanted.size();
    if (n > 1) apart = std::min(apart, (to - from) / static_cast<double>(n - 1));
    // Once pushed to the right only, once to the left only; the mean keeps the distance and stays in the
    // middle.
    std::vector<double> up(n), down(n), placed(n);
    for (std::size_t k = 0; k < n; ++k) up[k] = std::max(wanted[order[k]], k > 0 ? up[k - 1] + apart : from);
    for (std::size_t k = n; k-- > 0;)
        down[k] = std::min(wanted[order[k]], k + 1 < n ? down[k + 1] - apart : to);
    for (std::size_t k = 0; k < n; ++k) placed[k] = 0.5 * (up[k] + down[k]);
    for (std::size_t k = 0; k < n; ++k) placed[k] = std::max(placed[k], k > 0 ? placed[k - 1] + apart : from);
    for (std::size_t k = n; k-- > 0;) placed[k] = std::min(placed[k], k + 1 < n ? placed[k + 1] - apart : to);
    std::vector<double> result(n);
    for (std::size_t k = 0; k < n; ++k) result[order[k]] = placed[k];
    return result;
}

namespace {

// The value in brackets after `name`, overwritten: what fits of `with`, then blanks.
void overwrite(std::string& pdf, std::string_view name, std::string_view with) {
    const std::size_t found = pdf.find(name);
    if (found == std::string::npos) return;
    const std::size_t from = found + name.size();
    std::size_t to = from, depth = 1;
    for (; to < pdf.size(); ++to) {
        if (pdf[to] == '(') ++depth;
        if (pdf[to] == ')' && --depth == 0) break;
    }
    for (std::size_t i = from; i < to; ++i) pdf[i] = i - from < with.size() ? with[i - from] : ' ';
}

// gnuplot opens a group at every change of pen, most of them for nothing: a third of a picture's bytes.
std::string without_empty_groups(const std::string& svg) {
    std::string result, held;
    for (std::size_t from = 0; from < svg.size();) {
        const std::size_t end = std::min(svg.find('\n', from), svg.size() - 1) + 1;
        const std::string_view line = std::string_view(svg).substr(from, end - from);
        from = end;
        if (!held.empty() && line == "</g>\n") {
            held.clear();
            continue;
        }
        result += held;
        held.clear();
        (line.rfind("<g fill=\"none\" color=", 0) == 0 ? held : result) += line;
    }
    return result + held;
}

}  // namespace

std::string same_svg(std::string svg) {
    const std::size_t from = svg.find("<desc>");
    const std::size_t to = svg.find("</desc>");
    if (from != std::string::npos && to != std::string::npos && from < to)
        svg.erase(from, to + std::string_view("</desc>").size() - from);
    constexpr std::string_view unlawful = "]]>";
    for (std::size_t at = svg.find(unlawful); at != std::string::npos; at = svg.find(unlawful, at))
        svg.replace(at, unlawful.size(), "]]&gt;");
    return without_empty_groups(svg);
}

std::string same_pdf(std::string pdf) {
    overwrite(pdf, "/CreationDate (", "D:19700101000000Z");
    overwrite(pdf, "/Producer (", "cairo");
    return pdf;
}

namespace {

constexpr std::size_t max_cells = 400;  // cells of a map, each way: finer is not visible

// Dark to light without turning back, so that it reads in grey and to every kind of eye.
constexpr const char* palette =
    "0 '#08112f', 0.2 '#17396e', 0.4 '#1d6d86', 0.6 '#4aa27a', 0.8 '#b9c54b', 1 '#ffe94a'";

// One panel of one page, as gnuplot commands.
class PanelScript {
  public:
    PanelScript(GnuplotScript& script, const PictureLayout& page, const Panel& panel, const PanelLayout& box)
        : script_(script), page_(page), panel_(panel), box_(box) {}

    void write() {
        script_.line("reset");
        script_.line("set lmargin at screen {:.6f}\nset rmargin at screen {:.6f}", x(box_.left),
                     x(box_.right));
        script_.line("set tmargin at screen {:.6f}\nset bmargin at screen {:.6f}", y(box_.top),
                     y(box_.bottom));
        if (!panel_.title.empty())
            text(cut_to(visible_text(panel_.title), 100), box_.left, box_.title_y, "left font ',13'");
        axis("x", panel_.x, box_.x);
        axis("y", panel_.y, box_.y);
        script_.line("set tics out nomirror font ',11'\nset border 3 lc rgb '#404040'");
        script_.line("set grid lc rgb '{}' lt 1 lw 0.5 {}", panel_.map ? "#ffffff" : "#dddddd",
                     panel_.map ? "front dt (1,6)" : "back");
        legend();
        for (const Shade& shade : panel_.shades) draw(shade);
        for (const NamedLine& line : panel_.lines) draw(line);
        for (const LineLabel& label : box_.labels) draw(label);
        plot();
    }

  private:
    [[nodiscard]] double x(double px) const { return px / page_.width; }
    [[nodiscard]] double y(double px) const { return 1.0 - px / page_.height; }

    void text(const std::string& words, double at_x, double at_y, const char* how) {
        script_.line("set label {} at screen {:.6f},{:.6f} {} front", gnuplot_string(words), x(at_x), y(at_y),
                     how);
    }

    void axis(const char* name, const PlotAxis& axis, const PlotRange& range) {
        script_.axis(name, axis, range);
        if (name[0] == 'x') {
            script_.line("set xlabel {} font ',12' offset 0,0.2", gnuplot_string(axis_text(axis)));
        } else {
            // At a place of its own: gnuplot's would move with the width of the numbers, and off the page.
            text(axis_text(axis), box_.left - left_px + 16.0, 0.5 * (box_.top + box_.bottom),
                 "center rotate by 90 font ',12'");
        }
        script_.line("set format {} '%.10g'", name);
    }

    void legend() {
        if (box_.legend_rows == 0) {
            script_.line("unset key");
            return;
        }
        script_.line(
            "set key at screen {:.6f},{:.6f} left top vertical Left reverse maxrows {} samplen 2.4 spacing "
            "1.25 font ',12'",
            x(box_.legend_x), y(box_.legend_y), box_.legend_rows);
    }

    void draw(const Shade& shade) {
        const auto clip = [](double value, const PlotRange& range) {
            return std::isnan(value) ? range.from : std::min(std::max(value, range.from), range.to);
        };
        const double x0 = clip(shade.x_from, box_.x), x1 = clip(shade.x_to, box_.x);
        const double y0 = clip(shade.y_from, box_.y), y1 = clip(shade.y_to, box_.y);
        script_.line(
            "set object rectangle from {:.10g},{:.10g} to {:.10g},{:.10g} fc rgb '{}' fs transparent solid "
            "0.14 noborder behind",
            x0, y0, x1, y1, ink_rgb(shade.ink));
        const std::string words = visible_text(shade.name);
        const double left = share_along(box_.x, panel_.x.scale, x0),
                     right = share_along(box_.x, panel_.x.scale, x1);
        const double width_px = (right - left) * (box_.right - box_.left);
        if (words.empty() || text_px(words) > width_px) return;
        text(words, box_.left + 0.5 * (left + right) * (box_.right - box_.left),
             box_.bottom - share_along(box_.y, panel_.y.scale, y1) * (box_.bottom - box_.top) + 0.6 * line_px,
             "center font ',11' tc rgb '#404040'");
    }

    void draw(const NamedLine& line) {
        const auto s = segment_of(line, box_.x, box_.y);
        if (!s) return;
        // On a map grey would drown in the dark.
        const std::string ink = panel_.map ? "#ffffff" : ink_rgb(line.ink);
        script_.line("set arrow from {:.10g},{:.10g} to {:.10g},{:.10g} nohead {} lc rgb '{}' lw 1 {}", s->x0,
                     s->y0, s->x1, s->y1, panel_.map ? "front" : "back", ink,
                     line.dashed ? "dt (6,4)" : "dt 1");
    }

    void draw(const LineLabel& label) {
        if (label.on_top) {
            leader(label.anchor_px, box_.top, label.at_px, box_.top - 13.0);
            text(label.text, label.at_px, box_.top - 17.0, "left rotate by 90 font ',11'");
        } else {
            leader(box_.right, label.anchor_px, box_.right + 11.0, label.at_px);
            text(label.text, box_.right + 15.0, label.at_px, "left font ',11'");
        }
    }

    void leader(double x0, double y0, double x1, double y1) {
        script_.line(
            "set arrow from screen {:.6f},{:.6f} to screen {:.6f},{:.6f} nohead lc rgb '#808080' lw 0.7",
            x(x0), y(y0), x(x1), y(y1));
    }

    void map(std::vector<std::string>& parts) {
        const auto pixels = [](double width, std::size_t cells) {
            return std::min({static_cast<std::size_t>(width), max_cells, 4 * cells});
        };
        const HeatMap& whole = *panel_.map;
        const std::size_t columns = pixels(box_.right - box_.left, whole.x_edges.size() - 1);
        const std::size_t rows = pixels(box_.bottom - box_.top, whole.y_edges.size() - 1);
        const HeatMap raster = rasterised(whole, box_.x, panel_.x.scale, box_.y, panel_.y.scale,
                                          {.columns = columns, .rows = rows});
        script_.line("set palette defined ({})\nset cbrange [{:.10g}:{:.10g}]", palette, whole.lowest,
                     whole.highest);
        if (whole.scale == PlotScale::logarithmic) script_.line("set logscale cb");
        if (const std::string ticks = gnuplot_ticks({whole.lowest, whole.highest}, whole.scale);
            !ticks.empty())
            script_.line("set cbtics {}", ticks);
        script_.line("set format cb '%.10g'\nset cbtics out nomirror font ',11'");
        script_.line("set colorbox user origin screen {:.6f},{:.6f} size screen {:.6f},{:.6f} noborder",
                     x(colours_left()), y(box_.bottom), x(13.0), y(box_.top) - y(box_.bottom));
        script_.line("set cblabel {} font ',12'", gnuplot_string(axis_text({whole.label, whole.unit})));
        script_.line(
            "set object rectangle from graph 0,0 to graph 1,1 fc rgb '#e4e4e4' fs solid noborder behind");
        const double dx = (box_.x.to - box_.x.from) / static_cast<double>(columns);
        const double dy = (box_.y.to - box_.y.from) / static_cast<double>(rows);
        const std::string data = script_.matrix(raster);
        parts.push_back(
            fmt::format("{} matrix using ({:.10g}+{:.10g}*$1):({:.10g}+{:.10g}*$2):3 with image notitle",
                        data, box_.x.from + 0.5 * dx, dx, box_.y.from + 0.5 * dy, dy));
    }

    // Right of the names of lines.
    [[nodiscard]] double colours_left() const {
        const double longest = longest_px(box_.labels, false);
        return box_.right + 16.0 + (longest > 0.0 ? longest + 14.0 : 0.0);
    }

    [[nodiscard]] std::string titled(const std::string& name) const {
        return name.empty() || box_.legend_rows == 0 ? "notitle" : "title " + gnuplot_string(name);
    }

    void draw(const Curve& whole, std::vector<std::string>& parts) {
        const auto buckets = static_cast<std::size_t>(box_.right - box_.left);
        const Curve curve = thinned(whole, buckets);
        const std::string data = script_.rows({&curve.x, &curve.y});
        const std::string ink = ink_rgb(curve.ink);
        const char* how = curve.style == CurveStyle::points    ? "points pt 7 ps 0.7"
                          : curve.style == CurveStyle::crosses ? "points pt 2 ps 0.7 lw 1.4"
                          : curve.style == CurveStyle::steps   ? "steps lw 1.6"
                          : curve.style == CurveStyle::stems   ? "impulses lw 1.6"
                          : curve.style == CurveStyle::dashed  ? "lines lw 1.4 dt (7,4)"
                                                               : "lines lw 1.5";
        parts.push_back(
            fmt::format("{} using 1:2 with {} lc rgb '{}' {}", data, how, ink, titled(curve.name)));
    }

    void plot() {
        std::vector<std::string> parts;
        if (panel_.map) map(parts);
        for (const Ribbon& ribbon : panel_.ribbons) {
            const std::string data = script_.rows({&ribbon.x, &ribbon.low, &ribbon.high});
            parts.push_back(fmt::format(
                "{} using 1:2:3 with filledcurves fs transparent solid 0.25 noborder fc rgb '{}' {}", data,
                ink_rgb(ribbon.ink), titled(ribbon.name)));
        }
        for (const Curve& curve : panel_.curves) draw(curve, parts);
        if (parts.empty()) parts.emplace_back("NaN notitle");
        script_.plot(parts);
    }

    GnuplotScript& script_;
    const PictureLayout& page_;
    const Panel& panel_;
    const PanelLayout& box_;
};

void open_page(GnuplotScript& script, const PictureLayout& page, PictureKind kind) {
    script.line("set encoding utf8");
    if (kind == PictureKind::svg) {
        script.line(
            "set terminal svg size {},{} noenhanced background rgb 'white' font 'sans-serif,12' name "
            "'ripplenotch'",
            page.width, page.height);
    } else if (kind == PictureKind::png) {
        script.line(
            "set terminal pngcairo size {},{} noenhanced background rgb 'white' font 'sans,12' fontscale "
            "0.75",
            page.width, page.height);
    } else {
        script.line(
            "set terminal pdfcairo size {:.2f}in,{:.2f}in noenhanced background rgb 'white' font 'sans,12' "
            "fontscale 0.72",
            page.width / 100.0, page.height / 100.0);
    }
}

std::string page_script(const Figure& figure, PictureKind kind) {
    const PictureLayout page = lay_out(figure);
    GnuplotScript script;
    open_page(script, page, kind);
    script.line("set multiplot");
    double at = 20.0;
    int number = 1000;  // apart from the labels of panels, which gnuplot counts itself
    const auto say = [&](const std::string& words, const char* font, double step) {
        script.line("set label {} {} at screen {:.6f},{:.6f} left font ',{}' front", number++,
                    gnuplot_string(words), 14.0 / page.width, 1.0 - at / page.height, font);
        at += step;
    };
    for (const std::string& words : page.title) say(words, "15", 20.0);
    for (const std::string& words : page.sentence) say(words, "12", line_px);
    // Nothing but the labels: a plot without axes carries them.
    script.line(
        "unset border\nunset tics\nunset key\nset margins 0,0,0,0\nset xrange [0:1]\nset yrange [0:1]\nplot "
        "NaN");
    for (std::size_t i = 0; i < figure.panels.size(); ++i)
        PanelScript(script, page, figure.panels[i], page.panels[i]).write();
    script.line("unset multiplot");
    return script.text();
}

}  // namespace

std::optional<std::string> draw_picture(const Figure& figure, PictureKind kind) {
    check_figure(figure);
    auto bytes = run_gnuplot(page_script(figure, kind));
    if (bytes && kind == PictureKind::svg) *bytes = same_svg(std::move(*bytes));
    if (bytes && kind == PictureKind::pdf) *bytes = same_pdf(std::move(*bytes));
    return bytes;
}

}  // namespace ripplenotch
