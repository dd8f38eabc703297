// SPDX-License-Identifier: MIT
#include "page/plotly_traces.hpp"

#include <algorithm>

#include "figure/gnuplot_script.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/portable_math.hpp"
#include "ripplenotch/core/visible_text.hpp"
#include "ripplenotch/figure/min_max.hpp"

namespace ripplenotch {
namespace {

Json numbers_json(const std::vector<double>& values) {
    Json array = Json::array();
    for (const double value : values) array.push_back(plotly_number(value));
    return array;
}

const char* dash_of(CurveStyle style) { return style == CurveStyle::dashed ? "dash" : "solid"; }

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

}  // namespace

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

Json plotly_number(double value) {
    if (!std::isfinite(value)) return nullptr;
    return *parse_number(fmt::format("{:.8g}", value));
}

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

}  // namespace ripplenotch
