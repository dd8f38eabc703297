// SPDX-License-Identifier: MIT
#include "figure/picture_layout.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "figure/gnuplot_script.hpp"
#include "ripplenotch/core/visible_text.hpp"

namespace ripplenotch {
namespace {

constexpr double page_width = 900.0, wide_page_width = 1160.0;
constexpr double right_px = 22.0, box_height = 250.0, below_px = 50.0, colours_px = 96.0;
constexpr double label_apart_px = 15.0;
constexpr std::size_t longest_label = 32;

double px(const std::string& text) { return letter_px * static_cast<double>(text_width(text)); }

struct Frame {
    double left, top, width, beside;  ///< beside: kept free at the right, in all panels alike
};

// Labels of the lines that pass through the panel, not yet placed.
std::vector<LineLabel> labels_of(const Panel& panel, const PlotRange& x, const PlotRange& y) {
    std::vector<LineLabel> labels;
    for (std::size_t i = 0; i < panel.lines.size(); ++i) {
        const NamedLine& line = panel.lines[i];
        Segment segment{};
        if (line.name.empty() || !segment_of(line, x, y, segment)) continue;
        const bool leaves_on_top = segment.y1 >= y.to - 1e-9 * (y.to - y.from);
        const bool on_top =
            line.run == NamedLine::Run::at_x ||
            (line.run == NamedLine::Run::ray && leaves_on_top && segment.x1 < x.to - 1e-9 * (x.to - x.from));
        labels.push_back({i, cut_to(visible_text(line.name), longest_label), on_top, 0.0, 0.0});
    }
    return labels;
}

double longest_px(const std::vector<LineLabel>& labels, bool on_top) {
    double longest = 0.0;
    for (const LineLabel& label : labels)
        if (label.on_top == on_top)
            longest = std::max(longest, small_letter_px * static_cast<double>(text_width(label.text)));
    return longest;
}

void place(std::vector<LineLabel>& labels, const Panel& panel, const PanelLayout& box, bool on_top) {
    std::vector<std::size_t> mine;
    std::vector<double> wanted;
    for (std::size_t i = 0; i < labels.size(); ++i) {
        if (labels[i].on_top != on_top) continue;
        Segment segment{};
        (void)segment_of(panel.lines[labels[i].line], box.x, box.y, segment);
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

// What the widest panel needs, so that the axes of panels one below the other line up.
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
        for (const std::string& name : names) longest = std::max(longest, px(name) + 60.0);
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

}  // namespace ripplenotch
