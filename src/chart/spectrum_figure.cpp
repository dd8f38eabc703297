// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/matrices/least_squares.hpp"
#include "ripplenotch/chart/figures.hpp"
#include "ripplenotch/core/gear_account.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/figure/min_max.hpp"

namespace ripplenotch {

namespace {

constexpr std::size_t most_bins = 400;

/// Columns of the figure: the map's speeds, with empty ones where no speed was measured.
struct Columns {
    std::vector<double> edges;
    std::vector<std::optional<std::size_t>> row;  ///< row of the map; empty: no speed here
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
            NamedLine line{order_in_words(order, lines.gear->ratio), NamedLine::Run::ray,
                           per_output_turn / 360.0};
            if (!campbell) {
                line.run = NamedLine::Run::at_y;
                line.value = lines.axis_per_motor_turn ? order.value() : per_output_turn;
            }
            panel.lines.push_back(std::move(line));
        }
    }
    Figure figure{campbell ? "campbell" : "order-map",
                  fmt::format("{} of the torque: {}", campbell ? "Campbell diagram" : "Order map", source),
                  fmt::format("{} speeds, resolution {:.3g} {}{}.", map.speed_deg_s.size(), map.resolution,
                              campbell ? "Hz" : "orders",
                              panel.lines.empty() || !lines.gear->has_ratio()
                                  ? std::string()
                                  : fmt::format("; lines are orders of a gear ratio of {:.6g}",
                                                lines.gear->ratio.value())),
                  {}};
    figure.panels.push_back(std::move(panel));
    return figure;
}

namespace {

std::string name_of(const Line& line) {
    if (line.kind == LineKind::tone && line.hz) return fmt::format("tone {:.4g} Hz", *line.hz);
    const std::string what =
        line.kind == LineKind::order ? "" : std::string(line_kind_name(line.kind)) + ": ";
    if (line.order) return fmt::format("{}order {:.4g}", what, *line.order);
    if (line.order_output) return fmt::format("{}{:.5g} per output turn", what, *line.order_output);
    return line.hz ? fmt::format("{}{:.4g} Hz", what, *line.hz) : "line";
}

Ink ink_of(const Line& line) {
    if (line.kind == LineKind::tone) return tone_ink;
    return line.kind == LineKind::order && line.order ? order_ink(*line.order) : unknown_ink;
}

// A line that is no order also has a mark of its own.
CurveStyle style_of(const Line& line) {
    return line.kind == LineKind::order && line.order ? order_style(*line.order, CurveStyle::points)
                                                      : other_mark(CurveStyle::points);
}

Curve points(const Line& line, double AmplitudeAtSpeed::*what) {
    Curve curve{name_of(line), ink_of(line), style_of(line), {}, {}};
    for (const AmplitudeAtSpeed& at : line.by_speed) {
        curve.x.push_back(std::abs(at.speed_deg_s));
        curve.y.push_back(at.*what);
    }
    return curve;
}

Panel frequency_panel(const Identification& found) {
    Panel panel{.title = "Frequency of each line against joint speed",
                .x = {"joint speed", "deg/s"},
                .y = {"frequency", "Hz"}};
    panel.x.from = panel.y.from = 0.0;
    for (const Line& line : found.lines) {
        panel.curves.push_back(points(line, &AmplitudeAtSpeed::hz));
        if (line.kind == LineKind::tone && line.hz) {
            panel.lines.push_back({name_of(line), NamedLine::Run::at_y, *line.hz, ink_of(line)});
        } else if (line.kind == LineKind::order && found.gear_ratio.value && line.order) {
            panel.lines.push_back({fmt::format("order {:.4g}", *line.order), NamedLine::Run::ray,
                                   *line.order * *found.gear_ratio.value / 360.0, ink_of(line)});
        } else if (line.kind == LineKind::order && line.order_output) {
            panel.lines.push_back({fmt::format("{:.5g} v / 360", *line.order_output), NamedLine::Run::ray,
                                   *line.order_output / 360.0, ink_of(line)});
        }
    }
    return panel;
}

Panel residual_panel(const GearRatioFit& fit) {
    Panel panel{.title = "Frequency residual of the gear ratio fit",
                .x = {"joint speed", "deg/s"},
                .y = {"residual", "Hz"},
                .height = 0.6};
    panel.x.from = 0.0;
    Curve curve{"", Ink::blue, CurveStyle::points, {}, {}};
    for (const GearRatioFit::Residual& residual : fit.residuals) {
        curve.x.push_back(std::abs(residual.speed_deg_s));
        curve.y.push_back(residual.residual_hz);
    }
    panel.curves.push_back(std::move(curve));
    panel.lines.push_back({"", NamedLine::Run::at_y, 0.0});
    return panel;
}

Panel empty_amplitude_panel(std::string title) {
    Panel panel{.title = std::move(title),
                .x = {"joint speed", "deg/s"},
                .y = {"amplitude, zero to peak", "Nm"},
                .height = 0.6};
    panel.x.from = panel.y.from = 0.0;
    return panel;
}

Panel amplitude_panel(const std::vector<Line>& lines) {
    Panel panel = empty_amplitude_panel("Amplitude of each line against joint speed");
    panel.legend = false;
    for (const Line& line : lines) panel.curves.push_back(points(line, &AmplitudeAtSpeed::amplitude_nm));
    return panel;
}

/// With 95 % intervals; backward has the colour of its order and the other mark, as in a ripple map.
Panel amplitude_panel(const std::vector<RippleAtSpeed>& ripple) {
    Panel panel =
        empty_amplitude_panel("Amplitude of each order by speed and direction, with 95 % intervals");
    for (const RippleAtSpeed& at : ripple) {
        const double order = at.ripple.order;
        const CurveStyle style = order_style(order, CurveStyle::line);
        const std::string name =
            fmt::format("order {:.4g} {}", order, at.direction < 0 ? "backward" : "forward");
        auto curve = std::find_if(panel.curves.begin(), panel.curves.end(),
                                  [&](const Curve& one) { return one.name == name; });
        if (curve == panel.curves.end()) {
            panel.ribbons.push_back({"", order_ink(order), {}, {}, {}});
            curve = panel.curves.insert(
                curve, {name, order_ink(order), at.direction < 0 ? other_mark(style) : style, {}, {}});
        }
        Ribbon& ribbon = panel.ribbons[static_cast<std::size_t>(curve - panel.curves.begin())];
        const double half = normal_95_errors * at.ripple.standard_error_nm;
        curve->x.push_back(at.speed_deg_s);
        curve->y.push_back(at.ripple.amplitude_nm);
        ribbon.x.push_back(at.speed_deg_s);
        ribbon.low.push_back(std::max(0.0, at.ripple.amplitude_nm - half));
        ribbon.high.push_back(at.ripple.amplitude_nm + half);
    }
    // One speed makes no line.
    for (Curve& curve : panel.curves) {
        if (curve.x.size() > 1) continue;
        curve.style = curve.style == CurveStyle::line ? CurveStyle::points : other_mark(CurveStyle::points);
    }
    return panel;
}

}  // namespace

Figure identification_figure(const std::string& source, const Identification& found) {
    Figure figure{
        "line-frequency",
        fmt::format("Lines in the torque: {}{}", source, found.joint.empty() ? "" : ", joint " + found.joint),
        found.verdict,
        {frequency_panel(found)}};
    if (!found.gear_ratio.residuals.empty()) figure.panels.push_back(residual_panel(found.gear_ratio));
    if (!found.by_speed.empty())
        figure.panels.push_back(amplitude_panel(found.by_speed));
    else if (!found.lines.empty())
        figure.panels.push_back(amplitude_panel(found.lines));
    return figure;
}

namespace {

// The noise and a little below it; a spectrum without noise (simulated) must not fill the page with rounding.
double lowest_shown(const std::vector<double>& amplitude_nm, const std::vector<double>& floor_nm) {
    const double highest = *std::max_element(amplitude_nm.begin(), amplitude_nm.end());
    std::vector<double> known;
    for (const double floor : floor_nm)
        if (floor > 0.0) known.push_back(floor);
    double low = 1e-5 * highest;
    if (!known.empty()) {
        std::nth_element(known.begin(), known.begin() + static_cast<std::ptrdiff_t>(known.size() / 2),
                         known.end());
        low = std::max(low, 0.25 * known[known.size() / 2]);
    }
    return std::min(low, 0.1 * highest);
}

std::vector<double> where_known(std::vector<double> floor_nm) {
    for (double& floor : floor_nm)
        if (!(floor > 0.0)) floor = not_a_number;
    return floor_nm;
}

PlotAxis amplitude_axis(const std::vector<double>& amplitude_nm, const std::vector<double>& floor_nm) {
    const double highest = *std::max_element(amplitude_nm.begin(), amplitude_nm.end());
    PlotAxis axis{"amplitude, zero to peak", "Nm", PlotScale::logarithmic};
    if (highest > 0.0) {
        axis.from = lowest_shown(amplitude_nm, floor_nm);
        axis.to = 1.5 * highest;
    }
    return axis;
}

Panel spectrum_panel(const Spectrum& spectrum) {
    Panel panel{
        .title = "", .x = {"frequency", "Hz"}, .y = amplitude_axis(spectrum.amplitude_nm, spectrum.floor_nm)};
    panel.curves.push_back(
        thinned({"torque", Ink::blue, CurveStyle::line, spectrum.hz, spectrum.amplitude_nm}));
    panel.curves.push_back(thinned(
        {"noise floor", Ink::black, CurveStyle::dashed, spectrum.hz, where_known(spectrum.floor_nm)}));
    for (std::size_t i = 0; i < std::min(spectrum.peaks.size(), max_named_lines); ++i) {
        const SpectralPeak& peak = spectrum.peaks[i];
        panel.lines.push_back({fmt::format("{:.4g} Hz, {:.3g} Nm", peak.hz, peak.amplitude_nm),
                               NamedLine::Run::at_x, peak.hz, Ink::vermilion});
    }
    return panel;
}

std::string lines_in_words(std::size_t count) {
    return count == 0   ? "No line rises above the noise"
           : count == 1 ? "One line rises above the noise"
                        : fmt::format("{} lines rise above the noise", count);
}

}  // namespace

Figure spectrum_figure(const std::string& source, const Spectrum& spectrum, bool smears_orders) {
    Figure figure{"spectrum",
                  fmt::format("Spectrum of the torque: {}", source),
                  lines_in_words(spectrum.peaks.size()) + ".",
                  {spectrum_panel(spectrum)}};
    if (smears_orders)
        figure.sentence +=
            " The speed changes: what turns with the joint is a line by order (--domain order), not here.";
    return figure;
}

Figure order_spectrum_figure(const std::string& source, const Stack& stack, const MotionLines& lines) {
    std::vector<double> order, amplitude_nm, floor_nm;
    for (std::size_t k = stack.first; k < stack.averages.size(); ++k) {
        order.push_back(static_cast<double>(k) * stack.spacing);
        amplitude_nm.push_back(stack.amplitude_nm[k]);
        floor_nm.push_back(stack.floor_nm[k]);
    }
    Panel panel{
        .title = "", .x = {"order", "cycles per output turn"}, .y = amplitude_axis(amplitude_nm, floor_nm)};
    panel.curves.push_back(thinned({"torque", Ink::blue, CurveStyle::line, order, amplitude_nm}));
    panel.curves.push_back(
        thinned({"noise floor", Ink::black, CurveStyle::dashed, order, where_known(std::move(floor_nm))}));
    for (const MotionLine& line : lines.lines) {
        if (line.kind == LineKind::tone || panel.lines.size() == max_named_lines) continue;
        panel.lines.push_back({fmt::format("order {:.5g}, {:.3g} Nm", line.order_output, line.amplitude_nm),
                               NamedLine::Run::at_x, line.order_output, Ink::vermilion});
    }
    return {"order-spectrum",
            fmt::format("Order spectrum of the torque: {}", source),
            fmt::format("{} over {:.3g} output turns.", lines_in_words(lines.lines.size()), lines.turns),
            {std::move(panel)}};
}

namespace {

std::vector<double> edges_of(std::size_t cells) {
    std::vector<double> edges;
    for (std::size_t k = 0; k <= cells; ++k) edges.push_back(static_cast<double>(k) + 0.5);
    return edges;
}

std::string numbered(const std::vector<std::string>& names) {
    std::vector<std::string> all;
    for (std::size_t k = 0; k < names.size(); ++k) all.push_back(fmt::format("{} {}", k + 1, names[k]));
    return fmt::format("{}", fmt::join(all, ", "));
}

}  // namespace

Figure motor_matrix_figure(const std::string& source, std::span<const Identification> joints) {
    const std::vector<std::string> motors = motors_in_matrix(joints);
    std::vector<std::string> torques;
    HeatMap heat{"amplitude, zero to peak", "Nm"};
    heat.x_edges = edges_of(motors.size());
    heat.y_edges = edges_of(joints.size());
    heat.highest = 0.0;
    for (const Identification& one : joints) {
        torques.push_back(one.joint);
        for (const std::string& motor : motors) {
            const auto amplitude = motor_amplitude(one, motor);
            heat.cells.push_back(amplitude.value_or(not_a_number));
            heat.highest = std::max(heat.highest, amplitude.value_or(0.0));
        }
    }
    if (!(heat.highest > 0.0)) heat.highest = 1.0;
    Panel panel{
        .title = "", .x = {"motor", "number", PlotScale::whole}, .y = {"torque", "number", PlotScale::whole}};
    panel.x.from = panel.y.from = 0.5;
    panel.x.to = heat.x_edges.back();
    panel.y.to = heat.y_edges.back();
    panel.map = std::move(heat);
    Figure figure{
        "motor-matrix",
        fmt::format("Ripple of each motor in each torque: {}", source),
        fmt::format("Motors: {}. Torques: {}. Empty: not found.", numbered(motors), numbered(torques)),
        {}};
    figure.panels.push_back(std::move(panel));
    return figure;
}

}  // namespace ripplenotch
