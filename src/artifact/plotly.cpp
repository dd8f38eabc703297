// SPDX-License-Identifier: MIT
#include "ripplenotch/artifact/plotly.hpp"

#include <algorithm>

#include "artifact/json.hpp"
#include "figure/gnuplot_script.hpp"
#include "figure/page_layout.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/figure/min_max.hpp"
#include "ripplenotch/figure/visible_text.hpp"

namespace ripplenotch {
namespace {

constexpr double plot_px = 780.0;  // a page's width less the margins; narrower screens scale it
constexpr double panel_px = 240.0, axis_px = 56.0, row_px = 24.0;

// Text that plotly shows as it is: neither its markup nor a template's %{...}.
std::string shown(const std::string& text) {
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

Json number_json(double value) {
    if (!std::isfinite(value)) return nullptr;
    return *parse_number(fmt::format("{:.8g}", value));
}

Json numbers_json(const std::vector<double>& values) {
    Json array = Json::array();
    for (const double value : values) array.push_back(number_json(value));
    return array;
}

const char* dash_of(CurveStyle style) { return style == CurveStyle::dashed ? "dash" : "solid"; }

std::string hover(const Panel& panel) {
    const auto unit = [](const PlotAxis& axis) { return axis.unit.empty() ? "" : " " + shown(axis.unit); };
    return fmt::format("{}: %{{x:.6~g}}{}<br>{}: %{{y:.6~g}}{}", shown(panel.x.label), unit(panel.x),
                       shown(panel.y.label), unit(panel.y));
}

// One panel of the figure; axes are numbered from 1, and 1 is written without its number.
class PlotlyPanel {
  public:
    PlotlyPanel(const Panel& panel, std::size_t number, Json& data, Json& layout)
        : panel_(panel),
          suffix_(number == 1 ? "" : std::to_string(number)),
          x_(x_range(panel)),
          y_(y_range(panel)),
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
        if (panel_.map) map(bottom, top);
        for (const Shade& shade : panel_.shades) draw(shade);
        for (const Ribbon& ribbon : panel_.ribbons) draw(ribbon);
        for (const Curve& curve : panel_.curves) draw(curve);
        lines();
        if (!panel_.title.empty()) {
            layout_["annotations"].push_back({{"text", shown(panel_.title)},
                                              {"xref", "paper"},
                                              {"yref", "paper"},
                                              {"x", 0},
                                              {"y", top + (names_px(true) + 6.0) / total_px},
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
    [[nodiscard]] double names_px(bool on_top) const {
        double longest = 0.0;
        for (const NamedLine& line : panel_.lines) {
            Segment s{};
            if (line.name.empty() || !segment_of(line, x_, y_, s) || on_top != leaves_on_top(line, s))
                continue;
            longest = std::max(longest, small_letter_px * static_cast<double>(text_width(shown_name(line))));
        }
        return longest > 0.0 ? longest + 22.0 : 0.0;
    }
    [[nodiscard]] double height_px() const {
        const double rows = panel_.legend ? static_cast<double>(legend_rows()) : 0.0;
        return names_px(true) + panel_px * panel_.height + axis_px + row_px * rows + 46.0;
    }
    [[nodiscard]] double above_px() const { return names_px(true) + 30.0; }

  private:
    static std::string shown_name(const NamedLine& line) { return cut_to(visible_text(line.name), 44); }
    [[nodiscard]] bool leaves_on_top(const NamedLine& line, const Segment& s) const {
        if (line.run == NamedLine::Run::at_x) return true;
        return line.run == NamedLine::Run::ray && s.y1 >= y_.to - 1e-9 * (y_.to - y_.from) &&
               s.x1 < x_.to - 1e-9 * (x_.to - x_.from);
    }
    [[nodiscard]] std::size_t legend_rows() const {
        double px = 0.0;
        for (const std::string& name : legend_names(panel_))
            px += letter_px * static_cast<double>(text_width(name)) + 60.0;
        return static_cast<std::size_t>(std::ceil(px / plot_px));
    }

    void axis(const char* which, const PlotAxis& axis, const PlotRange& range) {
        const bool log = axis.scale == PlotScale::logarithmic;
        Json& json = layout_[which + suffix_];
        json = {{"title", {{"text", shown(axis_text(axis))}, {"font", {{"size", 13}}}, {"standoff", 8}}},
                {"type", log ? "log" : "linear"},
                {"range", {log ? std::log10(range.from) : range.from, log ? std::log10(range.to) : range.to}},
                {"gridcolor", "#e3e3e3"},
                {"linecolor", "#555"},
                {"showline", true},
                {"zeroline", false},
                {"ticks", "outside"}};
        if (!log) json["tickformat"] = ".6~g";
    }

    Json trace(const std::string& type, const std::string& name) const {
        Json json{{"type", type},        {"xaxis", "x" + suffix_},       {"yaxis", "y" + suffix_},
                  {"name", shown(name)}, {"legend", "legend" + suffix_}, {"legendgroup", shown(name)}};
        json["showlegend"] = panel_.legend && !name.empty() && type == "scatter";
        return json;
    }

    void draw(const Curve& whole) {
        const Curve curve = thinned(whole);
        Json json = trace("scatter", curve.name);
        json["x"] = numbers_json(curve.x);
        json["y"] = numbers_json(curve.y);
        json["hovertemplate"] = hover(panel_) + (curve.name.empty() ? "<extra></extra>" : "");
        if (curve.style == CurveStyle::points) {
            json["mode"] = "markers";
            json["cliponaxis"] = false;
            json["marker"] = {{"color", ink_rgb(curve.ink)}, {"size", 6}};
        } else if (curve.style == CurveStyle::stems) {
            stems(json, curve);
        } else {
            json["mode"] = "lines";
            json["line"] = {{"color", ink_rgb(curve.ink)}, {"width", 1.5}, {"dash", dash_of(curve.style)}};
            if (curve.style == CurveStyle::steps) json["line"]["shape"] = "hv";
        }
        data_.push_back(std::move(json));
    }

    // Each stem is a line from zero; the null after it keeps it apart from the next.
    void stems(Json& json, const Curve& curve) {
        json["x"] = json["y"] = Json::array();
        for (std::size_t i = 0; i < curve.x.size(); ++i) {
            for (const Json& x : {number_json(curve.x[i]), number_json(curve.x[i]), Json(nullptr)})
                json["x"].push_back(x);
            for (const Json& y : {Json(0.0), number_json(curve.y[i]), Json(nullptr)}) json["y"].push_back(y);
        }
        json["mode"] = "lines";
        json["line"] = {{"color", ink_rgb(curve.ink)}, {"width", 2}};
    }

    void draw(const Ribbon& ribbon) {
        for (const bool upper : {false, true}) {
            Json json = trace("scatter", ribbon.name);
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
            data_.push_back(std::move(json));
        }
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
                                     {"x0", number_json(x0)},
                                     {"x1", number_json(x1)},
                                     {"y0", whole ? Json(0) : number_json(within(shade.y_from, y_))},
                                     {"y1", whole ? Json(1) : number_json(within(shade.y_to, y_))},
                                     {"fillcolor", ink_rgb(shade.ink) + "24"},
                                     {"line", {{"width", 0}}}});
        const double room_px = (x1 - x0) / (x_.to - x_.from) * 0.5 * plot_px;  // half: phones are narrow
        if (shade.name.empty() || small_letter_px * static_cast<double>(text_width(shade.name)) > room_px)
            return;
        layout_["annotations"].push_back({{"text", shown(shade.name)},
                                          {"xref", "x" + suffix_},
                                          {"yref", "y" + suffix_ + " domain"},
                                          {"x", number_json(0.5 * (x0 + x1))},
                                          {"y", 1},
                                          {"yanchor", "top"},
                                          {"showarrow", false},
                                          {"font", {{"size", 11}, {"color", "#444"}}}});
    }

    // The lines themselves, and their names pushed off each other at the edge where they leave.
    void lines() {
        for (const bool on_top : {true, false}) {
            std::vector<const NamedLine*> named;
            std::vector<Segment> segments;
            std::vector<double> wanted;
            for (const NamedLine& line : panel_.lines) {
                Segment s{};
                if (!segment_of(line, x_, y_, s) || on_top != leaves_on_top(line, s)) continue;
                draw(line, s);
                if (line.name.empty()) continue;
                named.push_back(&line);
                segments.push_back(s);
                wanted.push_back(on_top ? plot_px * share_along(x_, panel_.x.scale, s.x1)
                                        : panel_px * panel_.height *
                                              (1.0 - share_along(y_, panel_.y.scale, s.y1)));
            }
            const auto placed = pushed_apart(wanted, 16.0, 0.0, on_top ? plot_px : panel_px * panel_.height);
            for (std::size_t i = 0; i < named.size(); ++i)
                label(*named[i], segments[i], on_top, placed[i] - wanted[i]);
        }
    }

    void draw(const NamedLine& line, const Segment& s) {
        layout_["shapes"].push_back({{"type", "line"},
                                     {"layer", panel_.map ? "above" : "below"},
                                     {"xref", "x" + suffix_},
                                     {"yref", "y" + suffix_},
                                     {"x0", number_json(s.x0)},
                                     {"y0", number_json(s.y0)},
                                     {"x1", number_json(s.x1)},
                                     {"y1", number_json(s.y1)},
                                     {"line",
                                      {{"color", panel_.map ? "#ffffffb0" : ink_rgb(line.ink)},
                                       {"width", 1},
                                       {"dash", line.dashed && !panel_.map ? "dash" : "solid"}}}});
    }

    // The name stands off its line's end by `push_px`; a leader ties them together.
    void label(const NamedLine& line, const Segment& s, bool on_top, double push_px) {
        const std::string x = "x" + suffix_, y = "y" + suffix_;
        const bool log = (on_top ? panel_.x : panel_.y).scale == PlotScale::logarithmic;
        const double where = on_top ? s.x1 : s.y1;
        layout_["annotations"].push_back(
            {{"text", shown(shown_name(line))},
             {"showarrow", false},
             {"font", {{"size", 11}}},
             {"xref", on_top ? x : x + " domain"},
             {"yref", on_top ? y + " domain" : y},
             {"x", on_top ? number_json(log ? std::log10(where) : where) : Json(1)},
             {"y", on_top ? Json(1) : number_json(log ? std::log10(where) : where)},
             {"xanchor", on_top ? "center" : "left"},
             {"yanchor", on_top ? "bottom" : "middle"},
             {"xshift", on_top ? push_px : 14.0},
             {"yshift", on_top ? 12.0 : -push_px},
             {"textangle", on_top ? -90 : 0}});
        layout_["shapes"].push_back({{"type", "line"},
                                     {"xref", on_top ? x : x + " domain"},
                                     {"yref", on_top ? y + " domain" : y},
                                     {"xsizemode", "pixel"},
                                     {"ysizemode", "pixel"},
                                     {"xanchor", on_top ? number_json(where) : Json(1)},
                                     {"yanchor", on_top ? Json(1) : number_json(where)},
                                     {"x0", 0},
                                     {"y0", 0},
                                     {"x1", on_top ? push_px : 11.0},
                                     {"y1", on_top ? 11.0 : -push_px},
                                     {"line", {{"color", "#888"}, {"width", 0.7}}}});
    }

    void map(double bottom, double top) {
        const HeatMap& map = *panel_.map;
        const std::size_t across = map.x_edges.size() - 1;
        const bool log = map.scale == PlotScale::logarithmic;
        Json json = trace("heatmap", map.label);
        json["x"] = numbers_json(map.x_edges);
        json["y"] = numbers_json(map.y_edges);
        Json z = Json::array(), said = Json::array();
        for (std::size_t row = 0; row + 1 < map.y_edges.size(); ++row) {
            Json z_row = Json::array(), said_row = Json::array();
            for (std::size_t column = 0; column < across; ++column) {
                const double cell = map.cells[row * across + column];
                z_row.push_back(number_json(log ? std::log10(within_colours(map, cell)) : cell));
                said_row.push_back(number_json(cell));
            }
            z.push_back(std::move(z_row));
            said.push_back(std::move(said_row));
        }
        json["z"] = std::move(z);
        json["customdata"] = std::move(said);
        json["zmin"] = log ? std::log10(map.lowest) : map.lowest;
        json["zmax"] = log ? std::log10(map.highest) : map.highest;
        json["colorscale"] = {{0, "#08112f"},   {0.2, "#17396e"}, {0.4, "#1d6d86"},
                              {0.6, "#4aa27a"}, {0.8, "#b9c54b"}, {1, "#ffe94a"}};
        json["hoverongaps"] = false;
        json["hovertemplate"] = fmt::format("{}<br>{}: %{{customdata:.4~g}} {}<extra></extra>", hover(panel_),
                                            shown(map.label), shown(map.unit));
        json["colorbar"] = {
            {"thickness", 14},
            {"len", top - bottom},
            {"y", 0.5 * (bottom + top)},
            {"outlinewidth", 0},
            {"x", 1.0 + (names_px(false) + 6.0) / plot_px},
            {"xanchor", "left"},
            {"title", {{"text", shown(axis_text({map.label, map.unit}))}, {"side", "right"}}}};
        if (log) colour_ticks(json["colorbar"], map);
        layout_["xaxis" + suffix_]["showgrid"] = layout_["yaxis" + suffix_]["showgrid"] = false;
        data_.push_back(std::move(json));
    }

    static void colour_ticks(Json& bar, const HeatMap& map) {
        bar["tickvals"] = bar["ticktext"] = Json::array();
        for (double decade = std::pow(10.0, std::floor(std::log10(map.lowest))); decade <= map.highest;
             decade *= 10.0) {
            for (const double step : {1.0, 2.0, 5.0}) {
                const double value = decade * step;
                if (value < map.lowest || value > map.highest) continue;
                bar["tickvals"].push_back(number_json(std::log10(value)));
                bar["ticktext"].push_back(fmt::format("{:.4g}", value));
            }
        }
    }

    const Panel& panel_;
    std::string suffix_;
    PlotRange x_, y_;
    Json& data_;
    Json& layout_;
};

bool alike(const Panel& a, const Panel& b) {
    const PlotRange x = x_range(a), y = x_range(b);
    const auto near = [](double p, double q, double span) { return std::abs(p - q) <= 1e-9 * span; };
    return a.x.label == b.x.label && a.x.unit == b.x.unit && a.x.scale == b.x.scale &&
           near(x.from, y.from, x.to - x.from) && near(x.to, y.to, x.to - x.from);
}

}  // namespace

std::string plotly_text(const Figure& figure) {
    check_figure(figure);
    Json data = Json::array();
    Json layout{{"shapes", Json::array()}, {"annotations", Json::array()}};
    double total_px = 0.0, beside_px = 24.0;
    std::vector<PlotlyPanel> panels;
    panels.reserve(figure.panels.size());
    for (std::size_t i = 0; i < figure.panels.size(); ++i) {
        panels.emplace_back(figure.panels[i], i + 1, data, layout);
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
    layout["height"] = total_px + 20.0;
    layout["margin"] = {{"l", 76}, {"r", beside_px}, {"t", 10}, {"b", 10}};
    layout["font"] = {{"family", "system-ui, sans-serif"}, {"size", 12}, {"color", "#1b1b1b"}};
    layout["plot_bgcolor"] =
        std::any_of(figure.panels.begin(), figure.panels.end(), [](const Panel& p) { return p.map; })
            ? "#eeeeee"
            : "#ffffff";
    layout["hovermode"] = "closest";
    layout["dragmode"] = "zoom";
    std::string text = Json{{"data", std::move(data)}, {"layout", std::move(layout)}}.dump(
        -1, ' ', false, Json::error_handler_t::replace);
    // "<br>" and "<extra>" of templates included: JSON reads it back the same.
    for (std::size_t at = text.find('<'); at != std::string::npos; at = text.find('<', at))
        text.replace(at, 1, "\\u003c");
    return text;
}

}  // namespace ripplenotch
