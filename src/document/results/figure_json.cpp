// SPDX-License-Identifier: MIT
#include "ripplenotch/document/figure_json.hpp"

#include "document/fields/document_head.hpp"
#include "document/json/json.hpp"
#include "ripplenotch/core/number.hpp"

namespace ripplenotch {
namespace {

// Eight digits are more than any picture shows, and keep a figure of many points small.
Json number_json(double value) {
    if (!std::isfinite(value)) return nullptr;
    return *parse_number(fmt::format("{:.8g}", value));
}

Json figure_numbers(const std::vector<double>& values) {
    Json array = Json::array();
    for (const double value : values) array.push_back(number_json(value));
    return array;
}

const char* scale_name(PlotScale scale) {
    return scale == PlotScale::linear ? "linear" : scale == PlotScale::whole ? "whole" : "logarithmic";
}

Json axis_json(const PlotAxis& axis, const PlotRange& range) {
    return {{"label", axis.label},
            {"unit", axis.unit},
            {"scale", scale_name(axis.scale)},
            {"from", number_json(range.from)},
            {"to", number_json(range.to)}};
}

const char* style_name(CurveStyle style) {
    switch (style) {
        case CurveStyle::dashed:
            return "dashed";
        case CurveStyle::steps:
            return "steps";
        case CurveStyle::points:
            return "points";
        case CurveStyle::stems:
            return "stems";
        case CurveStyle::crosses:
            return "crosses";
        case CurveStyle::line:
            break;
    }
    return "line";
}

const char* run_name(NamedLine::Run run) {
    if (run == NamedLine::Run::ray) return "ray";
    return run == NamedLine::Run::at_x ? "at-x" : "at-y";
}

Json map_json(const HeatMap& map) {
    return {{"label", map.label},
            {"unit", map.unit},
            {"scale", scale_name(map.scale)},
            {"lowest", number_json(map.lowest)},
            {"highest", number_json(map.highest)},
            {"x_edges", figure_numbers(map.x_edges)},
            {"y_edges", figure_numbers(map.y_edges)},
            {"cells", figure_numbers(map.cells)}};
}

Json panel_json(const Panel& panel) {
    Json json{{"title", panel.title},
              {"x", axis_json(panel.x, x_range(panel))},
              {"y", axis_json(panel.y, y_range(panel))},
              {"legend", panel.legend},
              {"height", panel.height},
              {"map", panel.map ? map_json(*panel.map) : Json(nullptr)},
              {"shades", Json::array()},
              {"ribbons", Json::array()},
              {"curves", Json::array()},
              {"lines", Json::array()}};
    for (const Shade& shade : panel.shades) {
        list_in(json, "shades")
            .push_back({{"name", shade.name},
                        {"ink", ink_rgb(shade.ink)},
                        {"x", {number_json(shade.x_from), number_json(shade.x_to)}},
                        {"y", {number_json(shade.y_from), number_json(shade.y_to)}}});
    }
    for (const Ribbon& ribbon : panel.ribbons) {
        list_in(json, "ribbons")
            .push_back({{"name", ribbon.name},
                        {"ink", ink_rgb(ribbon.ink)},
                        {"x", figure_numbers(ribbon.x)},
                        {"low", figure_numbers(ribbon.low)},
                        {"high", figure_numbers(ribbon.high)}});
    }
    for (const Curve& curve : panel.curves) {
        list_in(json, "curves")
            .push_back({{"name", curve.name},
                        {"ink", ink_rgb(curve.ink)},
                        {"style", style_name(curve.style)},
                        {"x", figure_numbers(curve.x)},
                        {"y", figure_numbers(curve.y)}});
    }
    for (const NamedLine& line : panel.lines) {
        list_in(json, "lines")
            .push_back({{"name", line.name},
                        {"ink", ink_rgb(line.ink)},
                        {"run", run_name(line.run)},
                        {"dashed", line.dashed},
                        {"value", number_json(line.value)}});
    }
    return json;
}

}  // namespace

std::string figure_text(const Figure& figure, const Provenance& provenance) {
    check_figure(figure);
    Json json = document_head("figure", {provenance.inputs, provenance.command});
    json["name"] = figure.name;
    json["title"] = figure.title;
    json["sentence"] = figure.sentence;
    json["columns"] = figure.columns;
    json["panels"] = Json::array();
    for (const Panel& panel : figure.panels) list_in(json, "panels").push_back(panel_json(panel));
    return json.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace ripplenotch
