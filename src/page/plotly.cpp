// SPDX-License-Identifier: MIT
#include "ripplenotch/page/page.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "document/json/json.hpp"
#include "figure/gnuplot_picture.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/portable_math.hpp"
#include "ripplenotch/core/visible_text.hpp"
#include "ripplenotch/figure/figure.hpp"
#include "ripplenotch/figure/min_max.hpp"

namespace ripplenotch {

namespace {

// eight digits; null for values that are not finite
Json plotly_number(double value) {
    if (!std::isfinite(value)) return nullptr;
    return *parse_number(fmt::format("{:.8g}", value));
}

Json numbers_json(const std::vector<double>& values) {
    Json array = Json::array();
    for (const double value : values) array.push_back(plotly_number(value));
    return array;
}

const char* dash_of(CurveStyle style) { return style == CurveStyle::dashed ? "dash" : "solid"; }

// Text that plotly shows as it is: neither its markup nor a template's %{...}.
std::string plotly_shown(const std::string& text) {
    std::string escaped;
    for (const char c : visible_text(text)) {
        if (c == '&' || c == '<' || c == '>' || c == '%' || c == '$') {
            escaped += fmt::format("&#{};", static_cast<int>(c));
        } else {
            escaped += c;
        }
    }
    return escaped;
}

std::string hover(const Panel& panel) {
    const auto unit = [](const PlotAxis& axis) {
        return axis.unit.empty() ? "" : " " + plotly_shown(axis.unit);
    };
    return fmt::format("{}: %{{x:.6~g}}{}<br>{}: %{{y:.6~g}}{}", plotly_shown(panel.x.label), unit(panel.x),
                       plotly_shown(panel.y.label), unit(panel.y));
}

// Each stem is a line from zero; the null after it keeps it apart from the next.
void stems(Json& json, const Curve& curve) {
    json["x"] = json["y"] = Json::array();
    for (std::size_t i = 0; i < curve.x.size(); ++i) {
        for (const Json& x : {plotly_number(curve.x[i]), plotly_number(curve.x[i]), Json(nullptr)})
            json["x"].push_back(x);
        for (const Json& y : {Json(0.0), plotly_number(curve.y[i]), Json(nullptr)}) json["y"].push_back(y);
    }
    json["mode"] = "lines";
    json["line"] = {{"color", ink_rgb(curve.ink)}, {"width", 2}};
}

void colour_ticks(Json& bar, const HeatMap& map) {
    bar["tickvals"] = bar["ticktext"] = Json::array();
    for (double decade = portable::pow(10.0, std::floor(portable::log10(map.lowest))); decade <= map.highest;
         decade *= 10.0) {
        for (const double step : {1.0, 2.0, 5.0}) {
            const double value = decade * step;
            if (value < map.lowest || value > map.highest) continue;
            bar["tickvals"].push_back(plotly_number(portable::log10(value)));
            bar["ticktext"].push_back(fmt::format("{:.4g}", value));
        }
    }
}

// The traces complete `json`, which holds the axes, the name and the legend already.

Json curve_trace(Json json, const Panel& panel, const Curve& whole) {
    const Curve curve = thinned(whole);
    json["x"] = numbers_json(curve.x);
    json["y"] = numbers_json(curve.y);
    json["hovertemplate"] = hover(panel) + (curve.name.empty() ? "<extra></extra>" : "");
    if (curve.style == CurveStyle::points || curve.style == CurveStyle::crosses) {
        json["mode"] = "markers";
        json["cliponaxis"] = false;
        json["marker"] = {{"color", ink_rgb(curve.ink)}, {"size", 6}};
        if (curve.style == CurveStyle::crosses) json["marker"]["symbol"] = "x";
    } else if (curve.style == CurveStyle::stems) {
        stems(json, curve);
    } else {
        json["mode"] = "lines";
        json["line"] = {{"color", ink_rgb(curve.ink)}, {"width", 1.5}, {"dash", dash_of(curve.style)}};
        if (curve.style == CurveStyle::steps) json["line"]["shape"] = "hv";
    }
    return json;
}

// The lower edge first, then the upper, which fills down to it.
Json ribbon_trace(Json json, const Ribbon& ribbon, bool upper) {
    json["x"] = numbers_json(ribbon.x);
    json["y"] = numbers_json(upper ? ribbon.high : ribbon.low);
    json["mode"] = "lines";
    json["line"] = {{"width", 0}, {"color", ink_rgb(ribbon.ink)}};
    json["hoverinfo"] = "skip";
    if (upper) {
        json["fill"] = "tonexty";
        json["fillcolor"] = ink_rgb(ribbon.ink) + "40";
    } else {
        json["showlegend"] = false;
    }
    return json;
}

// The colour bar is to the right of the panel, between `bottom` and `top` of the figure.
Json map_trace(Json json, const Panel& panel, double bottom, double top) {
    const HeatMap& map = *panel.map;
    const std::size_t across = map.x_edges.size() - 1;
    const bool log = map.scale == PlotScale::logarithmic;
    json["x"] = numbers_json(map.x_edges);
    json["y"] = numbers_json(map.y_edges);
    Json z = Json::array(), said = Json::array();
    for (std::size_t row = 0; row + 1 < map.y_edges.size(); ++row) {
        Json z_row = Json::array(), said_row = Json::array();
        for (std::size_t column = 0; column < across; ++column) {
            const double cell = map.cells[row * across + column];
            z_row.push_back(plotly_number(log ? portable::log10(within_colours(map, cell)) : cell));
            said_row.push_back(plotly_number(cell));
        }
        z.push_back(std::move(z_row));
        said.push_back(std::move(said_row));
    }
    json["z"] = std::move(z);
    json["customdata"] = std::move(said);
    json["zmin"] = log ? portable::log10(map.lowest) : map.lowest;
    json["zmax"] = log ? portable::log10(map.highest) : map.highest;
    json["colorscale"] = {{0, "#08112f"},   {0.2, "#17396e"}, {0.4, "#1d6d86"},
                          {0.6, "#4aa27a"}, {0.8, "#b9c54b"}, {1, "#ffe94a"}};
    json["hoverongaps"] = false;
    json["hovertemplate"] = fmt::format("{}<br>{}: %{{customdata:.4~g}} {}<extra></extra>", hover(panel),
                                        plotly_shown(map.label), plotly_shown(map.unit));
    json["colorbar"] = {
        {"thickness", 14},
        {"len", top - bottom},
        {"y", 0.5 * (bottom + top)},
        {"outlinewidth", 0},
        {"x", 1.01},
        {"xanchor", "left"},
        {"title", {{"text", plotly_shown(axis_text({map.label, map.unit}))}, {"side", "right"}}}};
    if (log) colour_ticks(json["colorbar"], map);
    return json;
}

// The named lines of a panel in a plotly figure: the name is where a line meets the edge of the panel, and
// names that would overlap are pushed apart.

constexpr double plot_px = 780.0;  ///< a page's width less the margins; narrower screens scale it

constexpr double panel_px = 240.0;  ///< height of a panel of height 1

std::string shown_name(const NamedLine& line) { return cut_to(visible_text(line.name), 28); }

class PlotlyLines {
  public:
    /// `suffix` of the panel's axes: empty, "2", "3", ...
    PlotlyLines(const Panel& panel, std::string suffix)
        : panel_(panel), suffix_(std::move(suffix)), x_(x_range(panel)), y_(y_range(panel)) {}

    /// Space for the names above the panel, or right of it.
    [[nodiscard]] double names_px(bool on_top) const {
        double longest = 0.0;
        for (const NamedLine& line : panel_.lines) {
            const auto s = segment_of(line, x_, y_);
            if (line.name.empty() || !s || on_top != s->on_top) continue;
            longest = std::max(longest, text_px(shown_name(line), small_letter_px));
        }
        return longest > 0.0 ? longest + 22.0 : 0.0;
    }

    /// Adds shapes and annotations: the lines themselves, and their names pushed off each other at the edge
    /// where they leave.
    void write(Json& layout) const {
        for (const bool on_top : {true, false}) {
            std::vector<const NamedLine*> named;
            std::vector<Segment> segments;
            std::vector<double> wanted;
            for (const NamedLine& line : panel_.lines) {
                const auto s = segment_of(line, x_, y_);
                if (!s || on_top != s->on_top) continue;
                draw(layout, line, *s);
                if (line.name.empty()) continue;
                named.push_back(&line);
                segments.push_back(*s);
                wanted.push_back(on_top ? plot_px * share_along(x_, panel_.x.scale, s->x1)
                                        : panel_px * panel_.height *
                                              (1.0 - share_along(y_, panel_.y.scale, s->y1)));
            }
            const auto placed = pushed_apart(wanted, 16.0, 0.0, on_top ? plot_px : panel_px * panel_.height);
            for (std::size_t i = 0; i < named.size(); ++i)
                label(layout, *named[i], segments[i], on_top, placed[i] - wanted[i]);
        }
    }

  private:
    void draw(Json& layout, const NamedLine& line, const Segment& s) const {
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
    void label(Json& layout, const NamedLine& line, const Segment& s, bool on_top, double push_px) const {
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

    const Panel& panel_;
    std::string suffix_;
    PlotRange x_, y_;
};

constexpr double left_margin_px = 84.0, tool_bar_px = 34.0;
constexpr double axis_px = 56.0, row_px = 24.0;

constexpr double phone_px = 280.0;  // a panel's width on a screen of 400

// Rows that the names of a panel's curves fill, set one after the other as far as there is space.
std::size_t legend_rows(const Panel& panel, double room_px) {
    if (!panel.legend) return 0;
    std::size_t rows = 0;
    double used_px = room_px + 1.0;
    for (const std::string& name : legend_names(panel)) {
        const double px = text_px(name) + 60.0;
        if (used_px + px > room_px) {
            ++rows;
            used_px = 0.0;
        }
        used_px += px;
    }
    return rows;
}

// One panel of the figure; axes are numbered from 1, and 1 is written without its number.
class PlotlyPanel {
  public:
    PlotlyPanel(const Panel& panel, std::size_t number, double room_px, Json& data, Json& layout)
        : panel_(panel),
          room_px_(room_px),
          suffix_(number == 1 ? "" : std::to_string(number)),
          x_(x_range(panel)),
          y_(y_range(panel)),
          lines_(panel, suffix_),
          data_(data),
          layout_(layout) {}

    void write(double bottom, double top, double total_px, const std::string& linked_to) {
        axis("xaxis", panel_.x, x_);
        axis("yaxis", panel_.y, y_);
        Json& x = layout_["xaxis" + suffix_];
        Json& y = layout_["yaxis" + suffix_];
        x["anchor"] = "y" + suffix_;
        y["anchor"] = "x" + suffix_;
        y["domain"] = {bottom, top};
        if (!linked_to.empty()) x["matches"] = linked_to;
        if (panel_.map) {
            x["showgrid"] = y["showgrid"] = false;
            data_.push_back(map_trace(trace("heatmap", panel_.map->label), panel_, bottom, top));
        }
        for (const Shade& shade : panel_.shades) draw(shade);
        for (const Ribbon& ribbon : panel_.ribbons) {
            for (const bool upper : {false, true})
                data_.push_back(ribbon_trace(trace("scatter", ribbon.name), ribbon, upper));
        }
        for (const Curve& curve : panel_.curves)
            data_.push_back(curve_trace(trace("scatter", curve.name), panel_, curve));
        lines_.write(layout_);
        if (!panel_.title.empty()) {
            layout_["annotations"].push_back({{"text", title_text()},
                                              {"xref", "paper"},
                                              {"yref", "paper"},
                                              {"x", 0},
                                              {"xshift", 12.0 - left_margin_px},
                                              {"align", "left"},
                                              {"y", top + (lines_.names_px(true) + 6.0) / total_px},
                                              {"xanchor", "left"},
                                              {"yanchor", "bottom"},
                                              {"showarrow", false},
                                              {"font", {{"size", 13}, {"color", "#222"}}}});
        }
        layout_["legend" + suffix_] = {{"orientation", "h"}, {"x", 0},
                                       {"xanchor", "left"},  {"y", bottom - axis_px / total_px},
                                       {"yanchor", "top"},   {"font", {{"size", 12}}}};
    }

    /// Space for the names of lines above the panel, or right of it.
    [[nodiscard]] double names_px(bool on_top) const { return lines_.names_px(on_top); }
    [[nodiscard]] double height_px() const {
        const auto rows = static_cast<double>(legend_rows(panel_, room_px_));
        return lines_.names_px(true) + panel_px * panel_.height + axis_px + row_px * rows + 46.0;
    }
    [[nodiscard]] double above_px() const {
        return lines_.names_px(true) + 12.0 + 18.0 * static_cast<double>(title_lines().size());
    }

  private:
    // Narrow enough for a phone.
    [[nodiscard]] std::vector<std::string> title_lines() const {
        return wrapped(visible_text(panel_.title), 44);
    }
    [[nodiscard]] std::string title_text() const { return joined(title_lines(), "<br>", plotly_shown); }
    // No longer than the axis that it belongs to.
    [[nodiscard]] std::string axis_title(std::string_view which, const PlotAxis& axis) const {
        const double room_px = which == "yaxis" ? panel_px * panel_.height : 0.5 * plot_px;
        return joined(wrapped(visible_text(axis_text(axis)), static_cast<std::size_t>(room_px / letter_px)),
                      "<br>", plotly_shown);
    }
    void axis(const char* which, const PlotAxis& axis, const PlotRange& range) {
        const bool log = axis.scale == PlotScale::logarithmic;
        Json& json = layout_[which + suffix_];
        json = {
            {"title", {{"text", axis_title(which, axis)}, {"font", {{"size", 13}}}, {"standoff", 8}}},
            {"type", log ? "log" : "linear"},
            {"range",
             {log ? portable::log10(range.from) : range.from, log ? portable::log10(range.to) : range.to}},
            {"gridcolor", "#e3e3e3"},
            {"linecolor", "#555"},
            {"showline", true},
            {"zeroline", false},
            {"ticks", "outside"}};
        if (!log) json["tickformat"] = ".6~g";
        if (axis.scale == PlotScale::whole) json["dtick"] = whole_step(range);
    }

    Json trace(const std::string& type, const std::string& name) const {
        Json json{{"type", type},
                  {"xaxis", "x" + suffix_},
                  {"yaxis", "y" + suffix_},
                  {"name", plotly_shown(name)},
                  {"legend", "legend" + suffix_},
                  {"legendgroup", plotly_shown(name)}};
        json["showlegend"] = panel_.legend && !name.empty() && type == "scatter";
        return json;
    }

    void draw(const Shade& shade) {
        const bool whole = !std::isfinite(shade.y_from) && !std::isfinite(shade.y_to);
        const auto within = [](double value, const PlotRange& range) {
            return std::isnan(value) ? range.from : std::clamp(value, range.from, range.to);
        };
        const double x0 = within(shade.x_from, x_), x1 = within(shade.x_to, x_);
        layout_["shapes"].push_back({{"type", "rect"},
                                     {"layer", "below"},
                                     {"xref", "x" + suffix_},
                                     {"yref", "y" + suffix_ + (whole ? " domain" : "")},
                                     {"x0", plotly_number(x0)},
                                     {"x1", plotly_number(x1)},
                                     {"y0", whole ? Json(0) : plotly_number(within(shade.y_from, y_))},
                                     {"y1", whole ? Json(1) : plotly_number(within(shade.y_to, y_))},
                                     {"fillcolor", ink_rgb(shade.ink) + "24"},
                                     {"line", {{"width", 0}}}});
        const double room_px = (x1 - x0) / (x_.to - x_.from) * 0.5 * plot_px;  // half: phones are narrow
        if (shade.name.empty() || text_px(shade.name, small_letter_px) > room_px) return;
        layout_["annotations"].push_back({{"text", plotly_shown(shade.name)},
                                          {"xref", "x" + suffix_},
                                          {"yref", "y" + suffix_ + " domain"},
                                          {"x", plotly_number(0.5 * (x0 + x1))},
                                          {"y", 1},
                                          {"yanchor", "top"},
                                          {"showarrow", false},
                                          {"font", {{"size", 11}, {"color", "#444"}}}});
    }

    const Panel& panel_;
    double room_px_;
    std::string suffix_;
    PlotRange x_, y_;
    PlotlyLines lines_;
    Json& data_;
    Json& layout_;
};

bool alike(const Panel& a, const Panel& b) {
    const PlotRange x = x_range(a), y = x_range(b);
    const auto near = [](double p, double q, double span) { return std::abs(p - q) <= 1e-9 * span; };
    return a.x.label == b.x.label && a.x.unit == b.x.unit && a.x.scale == b.x.scale &&
           near(x.from, y.from, x.to - x.from) && near(x.to, y.to, x.to - x.from);
}

// The figure where a panel is so wide.
Json drawn(const Figure& figure, double room_px) {
    Json data = Json::array();
    Json layout{{"shapes", Json::array()}, {"annotations", Json::array()}};
    double total_px = 0.0, beside_px = 24.0;
    std::vector<PlotlyPanel> panels;
    panels.reserve(figure.panels.size());
    for (std::size_t i = 0; i < figure.panels.size(); ++i) {
        panels.emplace_back(figure.panels[i], i + 1, room_px, data, layout);
        total_px += panels.back().height_px() + panels.back().above_px() - panels.back().names_px(true);
        beside_px =
            std::max(beside_px, panels.back().names_px(false) + 10.0 + (figure.panels[i].map ? 90.0 : 0.0));
    }
    double at_px = total_px;
    for (std::size_t i = 0; i < panels.size(); ++i) {
        at_px -= panels[i].above_px();
        const double top = at_px / total_px, bottom = (at_px - panel_px * figure.panels[i].height) / total_px;
        std::string linked;
        for (std::size_t k = 0; k < i && linked.empty(); ++k)
            if (alike(figure.panels[k], figure.panels[i]))
                linked = k == 0 ? "x" : "x" + std::to_string(k + 1);
        panels[i].write(bottom, top, total_px, linked);
        at_px -= panels[i].height_px() - panels[i].names_px(true);
    }
    layout["height"] = total_px + tool_bar_px + 10.0;
    layout["margin"] = {{"l", left_margin_px}, {"r", beside_px}, {"t", tool_bar_px}, {"b", 10}};
    layout["font"] = {{"family", "system-ui, sans-serif"}, {"size", 12}, {"color", "#1b1b1b"}};
    layout["plot_bgcolor"] =
        std::any_of(figure.panels.begin(), figure.panels.end(), [](const Panel& p) { return p.map; })
            ? "#eeeeee"
            : "#ffffff";
    layout["hovermode"] = "closest";
    layout["dragmode"] = "zoom";
    return Json{{"data", std::move(data)}, {"layout", std::move(layout)}};
}

// Differences on a narrow screen, where names of curves take more rows: paths and their values.
Json narrow_changes(const Figure& figure, const Json& wide) {
    Json changes = Json::array();
    const bool same = std::all_of(figure.panels.begin(), figure.panels.end(), [](const Panel& panel) {
        return legend_rows(panel, phone_px) == legend_rows(panel, plot_px);
    });
    if (same) return changes;
    const Json narrow = drawn(figure, phone_px);
    const auto add = [&](const Json& from, const Json& to, const std::string& place) {
        for (const Json& one : Json::diff(from, to))
            changes.push_back({{"path", place + one["path"].get<std::string>()}, {"value", one["value"]}});
    };
    add(wide["layout"], narrow["layout"], "/layout");
    for (std::size_t i = 0; i < wide["data"].size(); ++i) {
        const Json &trace = wide["data"][i], &other = narrow["data"][i];
        if (trace.contains("colorbar"))
            add(trace["colorbar"], other["colorbar"], "/data/" + std::to_string(i) + "/colorbar");
    }
    return changes;
}

}  // namespace

std::string plotly_text(const Figure& figure) {
    check_figure(figure);
    Json json = drawn(figure, plot_px);
    if (Json changes = narrow_changes(figure, json); !changes.empty()) json["narrow"] = std::move(changes);
    std::string text = json.dump(-1, ' ', false, Json::error_handler_t::replace);
    // "<br>" and "<extra>" of templates included: JSON reads it back the same.
    for (std::size_t at = text.find('<'); at != std::string::npos; at = text.find('<', at))
        text.replace(at, 1, "\\u003c");
    return text;
}

}  // namespace ripplenotch
