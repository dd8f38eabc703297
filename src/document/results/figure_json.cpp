// SPDX-License-Identifier: MIT
#include "ripplenotch/document/results.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "document/fields/fields.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/figure/figure.hpp"

namespace ripplenotch {

namespace {

constexpr Limits panel_height{0.1, 10.0};  // against the others
constexpr AtMost words{max_words};

// Eight digits are more than any picture shows, and keep a figure of many points small. Null is a nan: a
// break, an empty cell.
constexpr Rounded eight{[](double value) {
    return std::isfinite(value) ? Json(*parse_number(fmt::format("{:.8g}", value))) : Json(nullptr);
}};
constexpr Rounded eight_or_unknown{eight.json_of, true};

std::string_view scale_name(PlotScale scale) {
    return std::array{"linear", "logarithmic", "whole"}[static_cast<std::size_t>(scale)];
}

std::string_view style_name(CurveStyle style) {
    return std::array{
        "line", "dashed", "steps", "points", "stems", "crosses"}[static_cast<std::size_t>(style)];
}

std::string_view run_name(NamedLine::Run run) {
    return std::array{"at-x", "at-y", "ray"}[static_cast<std::size_t>(run)];
}

std::string_view ink_name(Ink ink) {
    static const std::vector<std::string> inks = [] {
        std::vector<std::string> all;
        for (int i = 0; i <= static_cast<int>(Ink::grey); ++i) all.push_back(ink_rgb(static_cast<Ink>(i)));
        return all;
    }();
    return inks[static_cast<std::size_t>(ink)];
}

constexpr Names scales{scale_name, PlotScale::whole};
constexpr Names inks{ink_name, Ink::grey};

// `spanned` is written: what the panel's contents span where the axis does not say.
template <class Archive>
void describe_axis(Archive& archive, auto& axis, PlotRange spanned) {
    archive("label", axis.label, words);
    archive("unit", axis.unit, words);
    archive("scale", axis.scale, scales);
    archive("from", spanned.from, eight);
    archive("to", spanned.to, eight);
    if constexpr (Archive::reading) {
        axis.from = spanned.from;
        axis.to = spanned.to;
        if (!(spanned.from < spanned.to) || (axis.scale == PlotScale::logarithmic && !(spanned.from > 0.0)))
            raise<DataError>("{}: cannot span {} to {}", archive.place(), spanned.from, spanned.to);
    }
}

// [from, to], null for an edge without end.
template <class Archive>
void describe_edges(Archive& archive, std::string_view name, auto& from, auto& to) {
    std::vector<double> edges{from, to};
    archive(name, edges, eight_or_unknown);
    if constexpr (Archive::reading) {
        if (edges.size() != 2)
            raise<DataError>("{}: {} numbers, expected 2", archive.where(name), edges.size());
        const double endless = std::numeric_limits<double>::infinity();
        from = std::isnan(edges[0]) ? -endless : edges[0];
        to = std::isnan(edges[1]) ? endless : edges[1];
    }
}

}  // namespace

void describe(auto& archive, Is<HeatMap> auto& map) {
    archive("label", map.label, words);
    archive("unit", map.unit, words);
    archive("scale", map.scale, scales);
    archive("lowest", map.lowest, eight);
    archive("highest", map.highest, eight);
    archive("x_edges", map.x_edges, eight_or_unknown);
    archive("y_edges", map.y_edges, eight_or_unknown);
    archive("cells", map.cells, eight_or_unknown);
}

void describe(auto& archive, Is<Shade> auto& shade) {
    archive("name", shade.name, words);
    archive("ink", shade.ink, inks);
    describe_edges(archive, "x", shade.x_from, shade.x_to);
    describe_edges(archive, "y", shade.y_from, shade.y_to);
}

void describe(auto& archive, Is<Ribbon> auto& ribbon) {
    archive("name", ribbon.name, words);
    archive("ink", ribbon.ink, inks);
    archive("x", ribbon.x, eight_or_unknown);
    archive("low", ribbon.low, eight_or_unknown);
    archive("high", ribbon.high, eight_or_unknown);
}

void describe(auto& archive, Is<Curve> auto& curve) {
    archive("name", curve.name, words);
    archive("ink", curve.ink, inks);
    archive("style", curve.style, Names{style_name, CurveStyle::crosses});
    archive("x", curve.x, eight_or_unknown);
    archive("y", curve.y, eight_or_unknown);
}

void describe(auto& archive, Is<NamedLine> auto& line) {
    archive("name", line.name, words);
    archive("ink", line.ink, inks);
    archive("run", line.run, Names{run_name, NamedLine::Run::ray});
    archive("dashed", line.dashed);
    archive("value", line.value, eight);
}

template <class Archive>
void describe(Archive& archive, Is<Panel> auto& panel) {
    PlotRange x, y;
    if constexpr (!Archive::reading) x = x_range(panel), y = y_range(panel);
    archive("title", panel.title, words);
    archive.group("x", [&](Archive& axis) { describe_axis(axis, panel.x, x); });
    archive.group("y", [&](Archive& axis) { describe_axis(axis, panel.y, y); });
    archive("legend", panel.legend);
    archive("height", panel.height, panel_height);
    archive("map", panel.map);
    archive("shades", panel.shades, AtMost{max_shades});
    archive("ribbons", panel.ribbons, AtMost{max_curves});
    archive("curves", panel.curves, AtMost{max_curves});
    archive("lines", panel.lines, AtMost{max_curves});
}

template <class Archive>
void describe(Archive& archive, Is<Figure> auto& figure) {
    archive("name", figure.name, words);
    archive("title", figure.title, words);
    archive("sentence", figure.sentence, words);
    if constexpr (Archive::reading)
        figure.columns = static_cast<int>(std::clamp(archive.number("columns"), 1.0, 4.0));
    else
        archive("columns", figure.columns);
    archive("panels", figure.panels, AtMost{max_panels});
}

std::string figure_text(const Figure& figure, const Provenance& provenance) {
    check_figure(figure);
    const Json json = document_of("figure", {provenance.inputs, provenance.command}, figure);
    return json.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
}

Figure figure_from_json(std::string_view text, const std::string& source) {
    Figure figure = result_of<Figure>(text, source, "figure");
    try {
        check_figure(figure);
    } catch (const std::logic_error& fault) {
        raise<DataError>("{}: {}", source, fault.what());
    }
    return figure;
}

}  // namespace ripplenotch
