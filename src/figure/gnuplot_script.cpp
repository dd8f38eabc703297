// SPDX-License-Identifier: MIT
#include "figure/gnuplot_script.hpp"

#include <algorithm>
#include <cmath>

#include "ripplenotch/core/portable_math.hpp"
#include "ripplenotch/core/visible_text.hpp"

namespace ripplenotch {
namespace {

bool harmless(char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
           std::string_view(" ,.:;()/+=-").find(c) != std::string_view::npos;
}

}  // namespace

std::string gnuplot_string(std::string_view text) {
    std::string quoted = "\"";
    for (const char c : visible_text(text)) {
        if (harmless(c)) {
            quoted += c;
        } else {
            quoted += fmt::format("\\{:03o}", static_cast<unsigned char>(c));
        }
    }
    return quoted + "\"";
}

std::string GnuplotScript::open_block() {
    const std::string name = fmt::format("$d{}", blocks_++);
    line("{} << END_OF_BLOCK", name);
    return name;
}

std::string GnuplotScript::rows(const std::vector<const std::vector<double>*>& columns) {
    std::string name = open_block();
    for (std::size_t i = 0; i < columns.front()->size(); ++i) {
        const bool whole = std::all_of(columns.begin(), columns.end(),
                                       [i](const auto* c) { return std::isfinite((*c)[i]); });
        for (const auto* column : columns) {
            if (whole) fmt::format_to(std::back_inserter(text_), "{:.8g} ", (*column)[i]);
        }
        text_ += '\n';
    }
    line("END_OF_BLOCK");
    return name;
}

std::string GnuplotScript::cells(const HeatMap& map, std::string_view levels) {
    std::string name = open_block();
    const std::size_t across = map.x_edges.size() - 1;
    const PlotRange colours{map.lowest, map.highest};
    for (std::size_t i = 0; i < map.cells.size(); ++i) {
        if (std::isnan(map.cells[i])) continue;
        const double share = share_along(colours, map.scale, within_colours(map, map.cells[i]));
        const auto level = static_cast<std::size_t>(share * 0.9999 * static_cast<double>(levels.size()));
        if (levels[level] == ' ') continue;
        const std::size_t column = i % across, row = i / across;
        line("{:.8g} {:.8g} \"{}\"", 0.5 * (map.x_edges[column] + map.x_edges[column + 1]),
             0.5 * (map.y_edges[row] + map.y_edges[row + 1]), levels[level]);
    }
    line("END_OF_BLOCK");
    return name;
}

std::string GnuplotScript::matrix(const HeatMap& map) {
    std::string name = open_block();
    const std::size_t across = map.x_edges.size() - 1;
    for (std::size_t i = 0; i < map.cells.size(); ++i) {
        const double value = within_colours(map, map.cells[i]);
        text_ += std::isnan(value) ? "NaN" : fmt::format("{:.5g}", value);
        text_ += (i + 1) % across == 0 ? '\n' : ' ';
    }
    line("END_OF_BLOCK");
    return name;
}

std::string gnuplot_ticks(const PlotRange& range, PlotScale scale) {
    constexpr double few_decades = 2.3;
    if (scale == PlotScale::whole) return fmt::format("{:g}", whole_step(range));
    if (scale == PlotScale::linear || portable::log10(range.to / range.from) > few_decades) return "";
    std::string ticks;
    for (int decade = static_cast<int>(std::floor(portable::log10(range.from)));
         decade <= portable::log10(range.to); ++decade) {
        for (const double step : {1.0, 2.0, 5.0}) {
            const double value = step * portable::pow(10.0, decade);
            if (value < range.from || value > range.to) continue;
            ticks += fmt::format("{}{:.6g}", ticks.empty() ? "" : ", ", value);
        }
    }
    return ticks.empty() ? "" : "(" + ticks + ")";
}

double within_colours(const HeatMap& map, double value) {
    return std::isnan(value) ? value : std::clamp(value, map.lowest, map.highest);
}

bool segment_of(const NamedLine& line, const PlotRange& x, const PlotRange& y, Segment& segment) {
    if (line.run == NamedLine::Run::at_x) {
        segment = {line.value, y.from, line.value, y.to};
        return line.value >= x.from && line.value <= x.to;
    }
    if (line.run == NamedLine::Run::at_y) {
        segment = {x.from, line.value, x.to, line.value};
        return line.value >= y.from && line.value <= y.to;
    }
    // A ray through the origin of slope value, from where it enters to where it leaves.
    double from = x.from, to = x.to;
    if (line.value != 0.0) {
        const double a = y.from / line.value, b = y.to / line.value;
        from = std::max(from, std::min(a, b));
        to = std::min(to, std::max(a, b));
    } else if (y.from > 0.0 || y.to < 0.0) {
        return false;
    }
    segment = {from, line.value * from, to, line.value * to};
    return from < to;
}

}  // namespace ripplenotch
