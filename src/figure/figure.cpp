// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "ripplenotch/core/portable_math.hpp"
#include "ripplenotch/figure/figure.hpp"

namespace ripplenotch {

namespace {

constexpr FigureKind list[] = {
#define FIGURE(name, command) {name, command},
#include "figure/figures.def"
#undef FIGURE
};

}  // namespace

std::string figures_of(std::string_view command) {
    std::string names;
    for (const FigureKind& kind : list) {
        if (kind.command == command) names += fmt::format("{}{}", names.empty() ? "" : ", ", kind.name);
    }
    return names;
}

void require_listed_figure(std::string_view name) {
    const auto same = [name](const FigureKind& kind) { return kind.name == name; };
    if (std::none_of(std::begin(list), std::end(list), same))
        throw std::logic_error(fmt::format("figure {} has no line in src/figure/figures.def", name));
}

namespace {

constexpr std::array<const char*, 8> inks = {"#000000", "#0072b2", "#d55e00", "#009e73",
                                             "#e69f00", "#cc79a7", "#56b4e9", "#808080"};

constexpr std::size_t inks_of_series = 6;

// Least and greatest of what an axis of this scale can show.
class Span {
  public:
    explicit Span(PlotScale scale) : scale_(scale) {}

    void include(double value) {
        if (!std::isfinite(value) || (scale_ == PlotScale::logarithmic && !(value > 0.0))) return;
        low_ = std::min(low_, value);
        high_ = std::max(high_, value);
    }
    void include(const std::vector<double>& values) {
        for (const double value : values) include(value);
    }

    [[nodiscard]] PlotRange range(const PlotAxis& axis, double widen) const {
        PlotRange range{low_, high_};
        if (!(low_ <= high_)) {
            range = scale_ == PlotScale::logarithmic ? PlotRange{0.1, 1.0} : PlotRange{0.0, 1.0};
        } else if (scale_ == PlotScale::logarithmic) {
            const double factor = high_ > low_ ? portable::pow(high_ / low_, widen) : 2.0;
            range = {low_ / factor, high_ * factor};
        } else {
            const double more = high_ > low_ ? widen * (high_ - low_) : std::max(0.5 * std::abs(high_), 0.5);
            range = {low_ - more, high_ + more};
        }
        if (axis.from) range.from = *axis.from;
        if (axis.to) range.to = *axis.to;
        if (!(range.from < range.to)) range.to = range.from + (range.from > 0.0 ? range.from : 1.0);
        return range;
    }

  private:
    PlotScale scale_;
    double low_ = std::numeric_limits<double>::infinity(), high_ = -std::numeric_limits<double>::infinity();
};

void demand(bool holds, const Figure& figure, const char* what) {
    if (!holds) throw std::logic_error("figure " + figure.name + ": " + what);
}

}  // namespace

std::string ink_rgb(Ink ink) { return inks[static_cast<std::size_t>(ink)]; }

Ink series_ink(std::size_t i) {
    constexpr std::array<Ink, inks_of_series> order = {Ink::blue,   Ink::vermilion, Ink::green,
                                                       Ink::orange, Ink::purple,    Ink::sky};
    return order[i % order.size()];
}

CurveStyle other_mark(CurveStyle style) {
    if (style == CurveStyle::line) return CurveStyle::dashed;
    return style == CurveStyle::points ? CurveStyle::crosses : style;
}

CurveStyle series_style(std::size_t i, CurveStyle style) {
    return i < inks_of_series ? style : other_mark(style);
}

Ink order_ink(double order) {
    const double whole = std::clamp(std::ceil(order - 1e-9), 1.0, 1e6);
    return series_ink(static_cast<std::size_t>(whole) - 1);
}

CurveStyle order_style(double order, CurveStyle style) {
    const bool whole = std::abs(order - std::round(order)) < 1e-9;
    return whole && order < static_cast<double>(inks_of_series) + 0.5 ? style : other_mark(style);
}

PlotRange x_range(const Panel& panel) {
    Span span(panel.x.scale);
    for (const Curve& curve : panel.curves) span.include(curve.x);
    for (const Ribbon& ribbon : panel.ribbons) span.include(ribbon.x);
    if (panel.map) span.include(panel.map->x_edges);
    for (const Shade& shade : panel.shades) {
        span.include(shade.x_from);
        span.include(shade.x_to);
    }
    return span.range(panel.x, 0.0);
}

PlotRange y_range(const Panel& panel) {
    Span span(panel.y.scale);
    for (const Curve& curve : panel.curves) {
        span.include(curve.y);
        if (curve.style == CurveStyle::stems) span.include(0.0);
    }
    for (const Ribbon& ribbon : panel.ribbons) {
        span.include(ribbon.low);
        span.include(ribbon.high);
    }
    if (panel.map) span.include(panel.map->y_edges);
    for (const Shade& shade : panel.shades) {
        span.include(shade.y_from);
        span.include(shade.y_to);
    }
    for (const NamedLine& line : panel.lines) {
        if (line.run == NamedLine::Run::at_y) span.include(line.value);
    }
    return span.range(panel.y, panel.map ? 0.0 : 0.05);
}

double whole_step(const PlotRange& range) {
    constexpr double most = 12.0;
    double step = 1.0;
    for (int i = 0; range.to - range.from > most * step; ++i) step *= i % 3 == 1 ? 2.5 : 2.0;
    return step;
}

double share_along(const PlotRange& range, PlotScale scale, double value) {
    if (scale != PlotScale::logarithmic) return (value - range.from) / (range.to - range.from);
    if (!(value > 0.0)) return std::numeric_limits<double>::quiet_NaN();
    return portable::log(value / range.from) / portable::log(range.to / range.from);
}

double value_at(const PlotRange& range, PlotScale scale, double share) {
    if (scale != PlotScale::logarithmic) return range.from + share * (range.to - range.from);
    return range.from * portable::pow(range.to / range.from, share);
}

std::string axis_text(const PlotAxis& axis) {
    return axis.unit.empty() ? axis.label : axis.label + ", " + axis.unit;
}

void check_figure(const Figure& figure) {
    demand(!figure.panels.empty(), figure, "no panel");
    demand(figure.columns > 0, figure, "no column");
    for (const Panel& panel : figure.panels) {
        demand(!panel.x.label.empty() && !panel.y.label.empty(), figure, "an axis without a label");
        for (const Curve& curve : panel.curves)
            demand(curve.x.size() == curve.y.size(), figure, "a curve's x and y differ in length");
        for (const Ribbon& ribbon : panel.ribbons) {
            demand(ribbon.x.size() == ribbon.low.size() && ribbon.x.size() == ribbon.high.size(), figure,
                   "a ribbon's edges differ in length");
        }
        if (!panel.map) continue;
        const HeatMap& map = *panel.map;
        demand(map.x_edges.size() > 1 && map.y_edges.size() > 1, figure, "a map without cells");
        demand(map.cells.size() == (map.x_edges.size() - 1) * (map.y_edges.size() - 1), figure,
               "a map's cells and edges do not agree");
    }
}

}  // namespace ripplenotch
