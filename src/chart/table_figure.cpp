// SPDX-License-Identifier: MIT
#include "ripplenotch/chart/table_figure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <limits>

#include "ripplenotch/core/how_many.hpp"
#include "ripplenotch/core/number.hpp"

namespace ripplenotch {
namespace {

constexpr double endless = std::numeric_limits<double>::infinity();

// A level in each band, nothing in the holes between them.
Curve stairs(const CandidateTable& table, std::string name, Ink ink,
             const std::function<double(const Band&)>& level, CurveStyle style = CurveStyle::line) {
    Curve curve{std::move(name), ink, style, {}, {}};
    for (const Band& band : table.bands()) {
        if (!curve.x.empty() && curve.x.back() < band.from.value()) {
            curve.x.push_back(band.from.value());
            curve.y.push_back(not_a_number);
        }
        for (const DegPerSec edge : {band.from, band.to}) {
            curve.x.push_back(edge.value());
            curve.y.push_back(level(band));
        }
    }
    return curve;
}

// Room for the numbers of the bands above the highest curve.
void leave_room(Panel& panel) {
    panel.y.from = 0.0;
    double highest = 0.0;
    for (const Curve& curve : panel.curves)
        for (const double y : curve.y)
            if (y > highest) highest = y;
    if (highest > 0.0) panel.y.to = 1.2 * highest;
}

PlotAxis speed_axis(const CandidateTable& table) {
    PlotAxis axis{"joint speed", "deg/s"};
    axis.from = 0.0;
    axis.to = 1.05 * table.bands().back().to.value();
    return axis;
}

// Every other band is shaded, every one is numbered.
std::vector<Shade> shades_of(const CandidateTable& table) {
    std::vector<Shade> shades;
    for (const Band& band : table.bands()) {
        shades.push_back({std::to_string(band.number), band.number % 2 == 1 ? Ink::grey : Ink::sky,
                          band.from.value(), band.to.value(), -endless, endless});
    }
    return shades;
}

Panel centre_panel(const CandidateTable& table) {
    const TableSpec& spec = table.spec();
    Panel panel{.title = "Centres of the notches in each band, and the ripple (dashed)",
                .x = speed_axis(table),
                .y = {"frequency", "Hz"}};
    panel.y.from = 0.0;
    panel.shades = shades_of(table);
    for (std::size_t i = 0; i < spec.orders.size(); ++i) {
        const double order = spec.orders[i].value();
        panel.curves.push_back(stairs(
            table, fmt::format("notch for order {}", shortest(order)), order_ink(order),
            [i](const Band& band) { return band.notches[i].notch.center.value(); },
            order_style(order, CurveStyle::line)));
        panel.lines.push_back({fmt::format("order {}", shortest(order)), NamedLine::Run::ray,
                               order * spec.gear_ratio.value() / 360.0, order_ink(order)});
    }
    const double highest_hz = spec.orders.back().value() * spec.gear_ratio.value() * *panel.x.to / 360.0;
    panel.y.to = std::min(1.1 * highest_hz, 0.5 * spec.sample_rate.value());
    return panel;
}

}  // namespace

Figure table_figure(const CandidateTable& table) {
    const TableSpec& spec = table.spec();
    Panel worst{.title = "Least attenuation of each line anywhere in its band",
                .x = speed_axis(table),
                .y = {"attenuation", "dB"},
                .height = 0.7};
    worst.shades = shades_of(table);
    for (std::size_t i = 0; i < spec.orders.size(); ++i) {
        const double order = spec.orders[i].value();
        worst.curves.push_back(stairs(
            table, fmt::format("order {}", shortest(order)), order_ink(order),
            [i](const Band& band) { return band.worst_attenuation_db[i]; },
            order_style(order, CurveStyle::line)));
    }
    leave_room(worst);
    Panel delay{.title = "What each band costs", .x = speed_axis(table), .y = {"time", "ms"}, .height = 0.7};
    delay.shades = shades_of(table);
    delay.curves.push_back(stairs(table, "delay at 0 Hz", Ink::blue,
                                  [](const Band& band) { return 1e3 * band.dc_delay.value(); }));
    delay.curves.push_back(
        stairs(table, fmt::format("settles to {} %", shortest(table.bands().front().settle_band_percent)),
               Ink::vermilion, [](const Band& band) { return 1e3 * band.settle.value(); }));
    leave_room(delay);
    return {"candidate-table",
            fmt::format("Candidate notches for gear ratio {:.6g} at {:.6g} Hz", spec.gear_ratio.value(),
                        spec.sample_rate.value()),
            fmt::format("{} from {:.6g} to {:.6g} deg/s, Q {}; numbers are bands.",
                        how_many(table.bands().size(), "band"), table.bands().front().from.value(),
                        table.bands().back().to.value(), shortest(spec.q)),
            {centre_panel(table), std::move(worst), std::move(delay)}};
}

Figure frontier_figure(const std::string& title, const std::string& sentence,
                       std::span<const FrontierPoint> points) {
    Panel panel{.title = "", .x = {"delay at 0 Hz", "ms"}, .y = {"least attenuation of a line", "dB"}};
    Curve frontier{"best that each delay buys", Ink::blue, CurveStyle::line, {}, {}};
    Curve designs{"designs", Ink::blue, CurveStyle::points, {}, {}};
    std::vector<FrontierPoint> own;
    for (const FrontierPoint& point : points)
        if (point.name.empty()) own.push_back(point);
    std::sort(own.begin(), own.end(),
              [](const FrontierPoint& a, const FrontierPoint& b) { return a.delay_ms < b.delay_ms; });
    for (const FrontierPoint& point : own) {
        for (Curve* curve : {&frontier, &designs}) {
            curve->x.push_back(point.delay_ms);
            curve->y.push_back(point.attenuation_db);
        }
        if (point.chosen) {
            panel.lines.push_back({"recommended", NamedLine::Run::at_x, point.delay_ms, Ink::vermilion});
        }
    }
    panel.curves = {std::move(frontier), std::move(designs)};
    std::size_t rival = 1;
    for (const FrontierPoint& point : points) {
        if (point.name.empty()) continue;
        panel.curves.push_back({point.name,
                                series_ink(rival),
                                series_style(rival, CurveStyle::points),
                                {point.delay_ms},
                                {point.attenuation_db}});
        ++rival;
    }
    return {"frontier", title, sentence, {std::move(panel)}};
}

}  // namespace ripplenotch
