// SPDX-License-Identifier: MIT
#include "page/plotly_lines.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "page/plotly_traces.hpp"
#include "ripplenotch/core/portable_math.hpp"
#include "ripplenotch/core/visible_text.hpp"

namespace ripplenotch {
namespace {

std::string shown_name(const NamedLine& line) { return cut_to(visible_text(line.name), 28); }

}  // namespace

PlotlyLines::PlotlyLines(const Panel& panel, std::string suffix)
    : panel_(panel), suffix_(std::move(suffix)), x_(x_range(panel)), y_(y_range(panel)) {}

double PlotlyLines::names_px(bool on_top) const {
    double longest = 0.0;
    for (const NamedLine& line : panel_.lines) {
        Segment s{};
        if (line.name.empty() || !segment_of(line, x_, y_, s) || on_top != leaves_on_top(line, s)) continue;
        longest = std::max(longest, small_letter_px * static_cast<double>(text_width(shown_name(line))));
    }
    return longest > 0.0 ? longest + 22.0 : 0.0;
}

bool PlotlyLines::leaves_on_top(const NamedLine& line, const Segment& s) const {
    if (line.run == NamedLine::Run::at_x) return true;
    return line.run == NamedLine::Run::ray && s.y1 >= y_.to - 1e-9 * (y_.to - y_.from) &&
           s.x1 < x_.to - 1e-9 * (x_.to - x_.from);
}

// The lines themselves, and their names pushed off each other at the edge where they leave.
void PlotlyLines::write(Json& layout) const {
    for (const bool on_top : {true, false}) {
        std::vector<const NamedLine*> named;
        std::vector<Segment> segments;
        std::vector<double> wanted;
        for (const NamedLine& line : panel_.lines) {
            Segment s{};
            if (!segment_of(line, x_, y_, s) || on_top != leaves_on_top(line, s)) continue;
            draw(layout, line, s);
            if (line.name.empty()) continue;
            named.push_back(&line);
            segments.push_back(s);
            wanted.push_back(on_top
                                 ? plot_px * share_along(x_, panel_.x.scale, s.x1)
                                 : panel_px * panel_.height * (1.0 - share_along(y_, panel_.y.scale, s.y1)));
        }
        const auto placed = pushed_apart(wanted, 16.0, 0.0, on_top ? plot_px : panel_px * panel_.height);
        for (std::size_t i = 0; i < named.size(); ++i)
            label(layout, *named[i], segments[i], on_top, placed[i] - wanted[i]);
    }
}

void PlotlyLines::draw(Json& layout, const NamedLine& line, const Segment& s) const {
    layout["shapes"].push_back({{"type", "line"},
                                {"layer", panel_.map ? "above" : "below"},
                                {"xref", "x" + suffix_},
                                {"yref", "y" + suffix_},
                                {"x0", plotly_number(s.x0)},
                                {"y0", plotly_number(s.y0)},
                                {"x1", plotly_number(s.x1)},
                                {"y1", plotly_number(s.y1)},
                                {"line",
                                 {{"color", panel_.map ? "#ffffffb0" : ink_rgb(line.ink)},
                                  {"width", 1},
                                  {"dash", line.dashed && !panel_.map ? "dash" : "solid"}}}});
}

// The name stands off its line's end by `push_px`; a leader ties them together.
void PlotlyLines::label(Json& layout, const NamedLine& line, const Segment& s, bool on_top,
                        double push_px) const {
    const std::string x = "x" + suffix_, y = "y" + suffix_;
    const bool log = (on_top ? panel_.x : panel_.y).scale == PlotScale::logarithmic;
    const double where = on_top ? s.x1 : s.y1;
    const bool inside = panel_.map && !on_top;
    Json note{{"text", plotly_shown(shown_name(line))},
              {"showarrow", false},
              {"font", {{"size", 11}, {"color", inside ? "#ffffff" : "#1b1b1b"}}},
              {"xref", on_top ? x : x + " domain"},
              {"yref", on_top ? y + " domain" : y},
              {"x", on_top ? plotly_number(log ? portable::log10(where) : where) : Json(1)},
              {"y", on_top ? Json(1) : plotly_number(log ? portable::log10(where) : where)},
              {"xanchor", on_top   ? "center"
                          : inside ? "right"
                                   : "left"},
              {"yanchor", on_top || inside ? "bottom" : "middle"},
              {"xshift", on_top   ? push_px
                         : inside ? -2.0
                                  : 14.0},
              {"yshift", on_top ? 12.0 : -push_px},
              {"textangle", on_top ? -90 : 0}};
    if (inside) note["bgcolor"] = "#08112fb0";
    layout["annotations"].push_back(std::move(note));
    if (inside) return;
    layout["shapes"].push_back({{"type", "line"},
                                {"xref", on_top ? x : x + " domain"},
                                {"yref", on_top ? y + " domain" : y},
                                {"xsizemode", "pixel"},
                                {"ysizemode", "pixel"},
                                {"xanchor", on_top ? plotly_number(where) : Json(1)},
                                {"yanchor", on_top ? Json(1) : plotly_number(where)},
                                {"x0", 0},
                                {"y0", 0},
                                {"x1", on_top ? push_px : 11.0},
                                {"y1", on_top ? 11.0 : -push_px},
                                {"line", {{"color", "#888"}, {"width", 0.7}}}});
}

}  // namespace ripplenotch
