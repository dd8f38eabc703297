// SPDX-License-Identifier: MIT
#include "ripplenotch/chart/identification_figure.hpp"

#include <fmt/format.h>

#include <cmath>

#include "ripplenotch/core/number.hpp"

namespace ripplenotch {
namespace {

std::string name_of(const Line& line) {
    if (line.kind == LineKind::tone && line.hz) return fmt::format("tone {:.4g} Hz", *line.hz);
    const std::string what =
        line.kind == LineKind::order ? "" : std::string(line_kind_name(line.kind)) + ": ";
    if (line.order) return fmt::format("{}order {}", what, shortest(*line.order));
    if (line.order_output) return fmt::format("{}{:.5g} per output turn", what, *line.order_output);
    return line.hz ? fmt::format("{}{:.4g} Hz", what, *line.hz) : "line";
}

Ink ink_of(const Line& line) {
    if (line.kind == LineKind::tone) return tone_ink;
    return line.kind == LineKind::order && line.order ? order_ink(*line.order) : unknown_ink;
}

// A line that is no order is told from orders by its mark, too.
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
            panel.lines.push_back({fmt::format("order {}", shortest(*line.order)), NamedLine::Run::ray,
                                   *line.order * *found.gear_ratio.value / 360.0, ink_of(line)});
        } else if (line.kind == LineKind::order && line.order_output) {
            panel.lines.push_back({fmt::format("{:.5g} v / 360", *line.order_output), NamedLine::Run::ray,
                                   *line.order_output / 360.0, ink_of(line)});
        }
    }
    return panel;
}

Panel residual_panel(const GearRatioFit& fit) {
    Panel panel{.title = "What the fit of the gear ratio leaves of the frequency",
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

}  // namespace

Figure identification_figure(const std::string& source, const Identification& found) {
    Figure figure{
        "line-frequency",
        fmt::format("Lines in the torque: {}{}", source, found.joint.empty() ? "" : ", joint " + found.joint),
        found.verdict,
        {frequency_panel(found)}};
    if (!found.gear_ratio.residuals.empty()) figure.panels.push_back(residual_panel(found.gear_ratio));
    Panel amplitude{.title = "Amplitude of each line against joint speed",
                    .x = {"joint speed", "deg/s"},
                    .y = {"amplitude, zero to peak", "Nm"},
                    .height = 0.6};
    amplitude.x.from = amplitude.y.from = 0.0;
    amplitude.legend = false;
    for (const Line& line : found.lines)
        amplitude.curves.push_back(points(line, &AmplitudeAtSpeed::amplitude_nm));
    if (!found.lines.empty()) figure.panels.push_back(std::move(amplitude));
    return figure;
}

}  // namespace ripplenotch
