// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <functional>
#include <limits>
#include <numbers>

#include "ripplenotch/chart/figures.hpp"
#include "ripplenotch/core/gear_account.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {

namespace {

constexpr int response_points = 600;
constexpr double lowest_share = 1e-4, highest_share = 0.499;  // shares of the sample rate

// Where a section's zeros lie on the unit circle, if they do.
std::optional<double> null_hz(const Biquad& section, Hertz sample_rate) {
    if (section.b0 == 0.0 || std::abs(section.b2 / section.b0 - 1.0) > 1e-9) return std::nullopt;
    const double cosine = -section.b1 / (2.0 * section.b0);
    if (!(std::abs(cosine) < 1.0)) return std::nullopt;
    return portable::acos(cosine) / (2.0 * std::numbers::pi) * sample_rate.value();
}

}  // namespace

FilterResponse filter_response(std::span<const Biquad> cascade, Hertz sample_rate,
                               std::span<const double> also_hz) {
    FilterResponse result;
    const double lowest = lowest_share * sample_rate.value(), highest = highest_share * sample_rate.value();
    for (int i = 0; i <= response_points; ++i)
        result.hz.push_back(lowest *
                            portable::pow(highest / lowest, static_cast<double>(i) / response_points));
    const auto add = [&](double hz) {
        if (hz > lowest && hz < highest) result.hz.push_back(hz);
    };
    std::vector<double> nulls;
    for (const double hz : also_hz) add(hz);
    for (const Biquad& section : cascade) {
        if (const auto hz = null_hz(section, sample_rate)) {
            nulls.push_back(*hz);
            // The phase jumps here: both sides of it are shown.
            for (const double share : {1.0 - 1e-6, 1.0, 1.0 + 1e-6}) add(share * *hz);
        }
    }
    std::sort(result.hz.begin(), result.hz.end());
    result.hz.erase(std::unique(result.hz.begin(), result.hz.end()), result.hz.end());
    for (const double hz : result.hz) {
        double magnitude = 1.0, phase_rad = 0.0;
        for (const Biquad& section : cascade) {
            const std::complex<double> gain = response(section, Hertz(hz), SampledAt(sample_rate));
            magnitude *= std::abs(gain);
            // A section turns by less than half a turn below half the sample rate, so its phase is not
            // folded.
            phase_rad += portable::arg(gain);
        }
        const double db = magnitude > 0.0 ? 20.0 * portable::log10(magnitude) : lowest_magnitude_db;
        result.magnitude_db.push_back(std::max(db, lowest_magnitude_db));
        const bool at_null = std::any_of(nulls.begin(), nulls.end(),
                                         [hz](double null) { return std::abs(hz / null - 1.0) < 1e-9; });
        result.phase_deg.push_back(at_null ? not_a_number : phase_rad * degrees_per_radian);
        result.group_delay_ms.push_back(
            at_null ? not_a_number : 1e3 * group_delay(cascade, Hertz(hz), SampledAt(sample_rate)).value());
    }
    return result;
}

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

// Adds space for the numbers of the bands above the highest curve.
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
        const std::string name = order_in_words(spec.orders[i], spec.gear_ratio);
        panel.curves.push_back(stairs(
            table, "notch for " + name, order_ink(order),
            [i](const Band& band) { return band.notches[i].notch.center.value(); },
            order_style(order, CurveStyle::line)));
        panel.lines.push_back(
            {name, NamedLine::Run::ray, order * spec.gear_ratio.value() / 360.0, order_ink(order)});
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
            table, order_in_words(spec.orders[i], spec.gear_ratio), order_ink(order),
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
    return {
        "candidate-table",
        fmt::format(
            "Candidate notches{} at {:.6g} Hz",
            spec.gear_ratio == no_ratio ? "" : fmt::format(" for gear ratio {:.6g}", spec.gear_ratio.value()),
            spec.sample_rate.value()),
        fmt::format("{} from {:.6g} to {:.6g} deg/s, Q {}; numbers are bands.",
                    how_many(table.bands().size(), "band"), table.bands().front().from.value(),
                    table.bands().back().to.value(), shortest(spec.q)),
        {centre_panel(table), std::move(worst), std::move(delay)}};
}

}  // namespace ripplenotch
