// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "ripplenotch/chart/spectrum_figure.hpp"
#include "ripplenotch/core/median.hpp"
#include "ripplenotch/core/number.hpp"

namespace ripplenotch {
namespace {

constexpr std::size_t most_bins = 400;

/// Columns of the figure: the map's speeds, with empty ones where no speed was measured.
struct Columns {
    std::vector<double> edges;
    std::vector<std::optional<std::size_t>> row;  ///< of the map; empty: no speed here
};

Columns columns_of(const SpeedMap& map) {
    Columns columns;
    const double half = 0.5 * map.speed_step_deg_s;
    const auto& speed = map.speed_deg_s;
    for (std::size_t i = 0; i < speed.size(); ++i) {
        double from = std::max(0.0, speed[i] - half), to = speed[i] + half;
        if (i > 0) from = std::max(from, 0.5 * (speed[i - 1] + speed[i]));
        if (i + 1 < speed.size()) to = std::min(to, 0.5 * (speed[i] + speed[i + 1]));
        if (columns.edges.empty()) columns.edges.push_back(from);
        if (from > columns.edges.back() + 1e-9 * to) {
            columns.row.emplace_back();
            columns.edges.push_back(from);
        }
        columns.row.emplace_back(i);
        columns.edges.push_back(to);
    }
    return columns;
}

// Neighbouring bins become one that is as high as the higher, so that no line goes missing.
HeatMap heat_map(const SpeedMap& map, const Columns& columns) {
    HeatMap heat{"amplitude, zero to peak", "Nm", PlotScale::logarithmic};
    const std::size_t bins = map.axis.size(), pool = (bins + most_bins - 1) / most_bins;
    heat.x_edges = columns.edges;
    for (std::size_t k = 0; k < bins; k += pool)
        heat.y_edges.push_back(std::max(0.0, map.axis[k] - 0.5 * map.spacing));
    heat.y_edges.push_back(map.axis.back() + 0.5 * map.spacing);
    std::vector<double> values;
    for (std::size_t k = 0; k < bins; k += pool) {
        for (const auto& row : columns.row) {
            double cell = not_a_number;
            for (std::size_t j = k; row && j < std::min(k + pool, bins); ++j) {
                const double amplitude = map.amplitude_nm[*row][j];
                cell = std::isnan(cell) ? amplitude : std::max(cell, amplitude);
            }
            heat.cells.push_back(cell);
            if (cell > 0.0) values.push_back(cell);
        }
    }
    if (values.empty()) return heat;
    heat.highest = *std::max_element(values.begin(), values.end());
    // Colours begin at the noise, but never span more than three decades.
    heat.lowest = std::min(std::max(median_in(values), 1e-3 * heat.highest), 0.1 * heat.highest);
    return heat;
}

}  // namespace

Figure speed_map_figure(const std::string& source, const SpeedMap& map, const MapLines& lines) {
    const bool campbell = map.axis_kind == Axis::time;
    Panel panel{.title = "", .x = {"joint speed", "deg/s"}, .y = {}};
    panel.x.from = 0.0;
    panel.y = campbell ? PlotAxis{"frequency", "Hz"}
                       : PlotAxis{"order", lines.axis_per_motor_turn ? "cycles per motor turn"
                                                                     : "cycles per output turn"};
    panel.y.from = 0.0;
    panel.map = heat_map(map, columns_of(map));
    panel.y.to = panel.map->y_edges.back();
    if (lines.gear) {
        for (const Order order : lines.gear->orders) {
            const double per_output_turn = order.value() * lines.gear->ratio.value();
            NamedLine line{fmt::format("order {}", shortest(order.value())), NamedLine::Run::ray,
                           per_output_turn / 360.0};
            if (!campbell) {
                line.run = NamedLine::Run::at_y;
                line.value = lines.axis_per_motor_turn ? order.value() : per_output_turn;
            }
            panel.lines.push_back(std::move(line));
        }
    }
    Figure figure{
        campbell ? "campbell" : "order-map",
        fmt::format("{} of the torque: {}", campbell ? "Campbell diagram" : "Order map", source),
        fmt::format("{} speeds, resolution {:.3g} {}{}.", map.speed_deg_s.size(), map.resolution,
                    campbell ? "Hz" : "orders",
                    panel.lines.empty() ? std::string()
                                        : fmt::format("; lines are orders of a gear ratio of {:.6g}",
                                                      lines.gear->ratio.value())),
        {}};
    figure.panels.push_back(std::move(panel));
    return figure;
}

}  // namespace ripplenotch
