// SPDX-License-Identifier: MIT
#include <array>
#include <limits>

#include "document/fields/fields.hpp"
#include "document/json/json.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/document/figure_json.hpp"

namespace ripplenotch {

namespace {

// One of these words, as its place in the list.
template <class Enum, std::size_t N>
Enum word_of(Fields& fields, std::string_view name, const std::array<const char*, N>& words) {
    const std::string text = fields.text(name);
    for (std::size_t i = 0; i < N; ++i)
        if (text == words[i]) return static_cast<Enum>(i);
    raise<DataError>("{}: '{}' is not what a figure knows, such as '{}'", fields.where(name), text,
                     words.front());
}

constexpr double lowest_panel = 0.1, highest_panel = 10.0;  // against the others
constexpr std::array scales = {"linear", "logarithmic", "whole"};
constexpr std::array styles = {"line", "dashed", "steps", "points", "stems", "crosses"};
constexpr std::array runs = {"at-x", "at-y", "ray"};

Ink ink_of(Fields& fields) {
    const std::string text = fields.text("ink");
    for (int i = 0; i < 8; ++i)
        if (text == ink_rgb(static_cast<Ink>(i))) return static_cast<Ink>(i);
    raise<DataError>("{}: '{}' is none of the eight inks, such as '{}'", fields.where("ink"), text,
                     ink_rgb(Ink::blue));
}

std::string words(Fields& fields, std::string_view name) {
    std::string text = fields.text(name);
    if (text.size() > most_words)
        raise<DataError>("{} has {} bytes, expected at most {}", fields.where(name), text.size(), most_words);
    return text;
}

// null is a nan: a break, an empty cell.
std::vector<double> numbers_or_nan(Fields& fields, std::string_view name) {
    const Json& array = fields.at(name);
    if (!array.is_array()) raise<DataError>("{}: not a list of numbers", fields.where(name));
    std::vector<double> values;
    for (const Json& entry : array) {
        if (!entry.is_number() && !entry.is_null())
            raise<DataError>("{}: holds {}, expected numbers and null", fields.where(name), in_words(entry));
        values.push_back(entry.is_null() ? std::numeric_limits<double>::quiet_NaN() : entry.get<double>());
    }
    return values;
}

// {from, to}, null for an edge without end.
std::pair<double, double> edges_of(Fields& fields, std::string_view name) {
    const std::vector<double> pair = numbers_or_nan(fields, name);
    if (pair.size() != 2) raise<DataError>("{}: {} numbers, expected 2", fields.where(name), pair.size());
    const double endless = std::numeric_limits<double>::infinity();
    return {std::isnan(pair[0]) ? -endless : pair[0], std::isnan(pair[1]) ? endless : pair[1]};
}

class FigureReader {
  public:
    explicit FigureReader(std::string source) : source_(std::move(source)) {}

    Panel panel(const Json& json, const std::string& path) const {
        Fields fields(json, source_, path);
        Panel panel;
        panel.title = words(fields, "title");
        panel.x = axis(fields.at("x"), path + ".x");
        panel.y = axis(fields.at("y"), path + ".y");
        panel.legend = flag(fields, "legend");
        panel.height = fields.number("height");
        if (!(panel.height >= lowest_panel && panel.height <= highest_panel))
            raise<DataError>("{} is {}, expected {} to {}", fields.where("height"), panel.height,
                             lowest_panel, highest_panel);
        if (const Json* map = fields.find("map")) panel.map = heat_map(*map, path + ".map");
        each(
            fields, "shades", path,
            [&](Fields& f) {
                const auto [x_from, x_to] = edges_of(f, "x");
                const auto [y_from, y_to] = edges_of(f, "y");
                panel.shades.push_back({words(f, "name"), ink_of(f), x_from, x_to, y_from, y_to});
            },
            most_shades);
        each(fields, "ribbons", path, [&](Fields& f) {
            panel.ribbons.push_back({words(f, "name"), ink_of(f), numbers_or_nan(f, "x"),
                                     numbers_or_nan(f, "low"), numbers_or_nan(f, "high")});
        });
        each(fields, "curves", path, [&](Fields& f) {
            panel.curves.push_back({words(f, "name"), ink_of(f), word_of<CurveStyle>(f, "style", styles),
                                    numbers_or_nan(f, "x"), numbers_or_nan(f, "y")});
        });
        each(fields, "lines", path, [&](Fields& f) {
            panel.lines.push_back({words(f, "name"), word_of<NamedLine::Run>(f, "run", runs),
                                   f.number("value"), ink_of(f), flag(f, "dashed")});
        });
        fields.finish();
        return panel;
    }

  private:
    static bool flag(Fields& fields, std::string_view name) {
        const Json& json = fields.at(name);
        if (!json.is_boolean()) raise<DataError>("{}: neither true nor false", fields.where(name));
        return json.get<bool>();
    }

    PlotAxis axis(const Json& json, const std::string& path) const {
        Fields fields(json, source_, path);
        PlotAxis axis{words(fields, "label"), words(fields, "unit"),
                      word_of<PlotScale>(fields, "scale", scales), fields.number("from"),
                      fields.number("to")};
        fields.finish();
        if (!(*axis.from < *axis.to) || (axis.scale == PlotScale::logarithmic && !(*axis.from > 0.0)))
            raise<DataError>("{}: {}: cannot span {} to {}", source_, path, *axis.from, *axis.to);
        return axis;
    }

    HeatMap heat_map(const Json& json, const std::string& path) const {
        Fields fields(json, source_, path);
        HeatMap map{words(fields, "label"),
                    words(fields, "unit"),
                    word_of<PlotScale>(fields, "scale", scales),
                    fields.number("lowest"),
                    fields.number("highest"),
                    numbers_or_nan(fields, "x_edges"),
                    numbers_or_nan(fields, "y_edges"),
                    numbers_or_nan(fields, "cells")};
        fields.finish();
        return map;
    }

    template <class Read>
    void each(Fields& fields, std::string_view name, const std::string& path, const Read& read,
              std::size_t most = most_curves) const {
        const Json& array = fields.list(name, most);
        for (std::size_t i = 0; i < array.size(); ++i) {
            Fields entry(array[i], source_, fmt::format("{}.{}[{}]", path, name, i));
            read(entry);
            entry.finish();
        }
    }

    std::string source_;
};

}  // namespace

Figure figure_from_json(std::string_view text, const std::string& source) {
    const Json json = parse_document(text, source, "figure");
    Fields fields(json, source, "");
    fields.ignore_head();
    Figure figure{words(fields, "name"), words(fields, "title"), words(fields, "sentence"), {}};
    figure.columns = static_cast<int>(std::clamp(fields.number("columns"), 1.0, 4.0));
    const Json& panels = fields.list("panels", most_panels);
    const FigureReader reader(source);
    for (std::size_t i = 0; i < panels.size(); ++i)
        figure.panels.push_back(reader.panel(panels[i], fmt::format("panels[{}]", i)));
    fields.finish();
    try {
        check_figure(figure);
    } catch (const std::logic_error& fault) {
        raise<DataError>("{}: {}", source, fault.what());
    }
    return figure;
}

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
