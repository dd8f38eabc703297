// SPDX-License-Identifier: MIT
#include "ripplenotch/chart/map_figure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/matrices/normal_errors.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

constexpr int steps = 40;

/// Amplitude and error at one speed, the second comb and the joint's turn averaged out.
struct At {
    std::complex<double> value;
    double error_nm = 0.0;
};

At at_speed(const MapFit& fit, std::size_t order, double speed_deg_s) {
    const MapForm& form = fit.map.form;
    std::vector<double> weights(form.columns());
    map_weights(fit.map, {speed_deg_s, fit.map.zero_deg, fit.map.loads_nm.middle()}, weights);
    At found;
    double square = 0.0;
    for (std::size_t c = 0; c < weights.size(); ++c) {
        const std::size_t within = c % form.columns_a_direction(), speeds = form.speeds_deg_s.size();
        if (within >= speeds && within < form.load_column()) continue;
        found.value += weights[c] * fit.map.values[order][c];
        square += weights[c] * weights[c] * 0.5 * std::norm(fit.errors[order][c]);
    }
    found.error_nm = std::sqrt(square);
    return found;
}

void add_curves(const MapFit& fit, std::size_t order, double sign, const std::string& name, double ordinal,
                Panel& amplitude, Panel& phase) {
    // Backward has the colour of its order and the other mark.
    const Ink ink = order_ink(ordinal);
    const auto style = [&](CurveStyle one) {
        return sign < 0.0 ? other_mark(one) : order_style(ordinal, one);
    };
    Curve size{name, ink, style(CurveStyle::line), {}, {}},
        angle{name, ink, style(CurveStyle::points), {}, {}};
    Ribbon ribbon{"", ink, {}, {}, {}}, doubt{"", ink, {}, {}, {}};
    const MapRange& range = fit.map.speeds_deg_s;
    for (int k = 0; k <= steps; ++k) {
        const double speed = range.from + (range.to - range.from) * k / steps;
        const At at = at_speed(fit, order, sign * speed);
        const double nm = portable::hypot(at.value.real(), at.value.imag());
        size.x.push_back(speed);
        size.y.push_back(nm);
        angle.x.push_back(speed);
        // A phase goes on where it ended: at half a turn it does not jump to the other edge.
        double deg = -portable::arg(at.value) * degrees_per_radian;
        if (k > 0) deg += 360.0 * std::round((angle.y.back() - deg) / 360.0);
        angle.y.push_back(deg);
        // Of an amplitude that may be 0 any phase may be.
        const double off = normal_95_errors * at.error_nm;
        const double off_deg = off < nm ? portable::atan2(off, nm) * degrees_per_radian : 180.0;
        doubt.x.push_back(speed);
        doubt.low.push_back(deg - off_deg);
        doubt.high.push_back(deg + off_deg);
        ribbon.x.push_back(speed);
        ribbon.low.push_back(std::max(0.0, nm - normal_95_errors * at.error_nm));
        ribbon.high.push_back(nm + normal_95_errors * at.error_nm);
    }
    amplitude.ribbons.push_back(std::move(ribbon));
    amplitude.curves.push_back(std::move(size));
    phase.ribbons.push_back(std::move(doubt));
    phase.curves.push_back(std::move(angle));
}

}  // namespace

Figure map_figure(const std::string& source, const MapFit& fit) {
    const PlotAxis speed{"joint speed", "deg/s"};
    Panel amplitude{.title = "Amplitude", .x = speed, .y = {"amplitude, zero to peak", "Nm"}};
    Panel phase{.title = "Phase against the motor's angle",
                .x = speed,
                .y = {"phase", "deg"},
                .legend = false,
                .height = 0.7};
    amplitude.y.from = 0.0;
    for (std::size_t i = 0; i < fit.map.orders.size(); ++i) {
        const std::string order = "order " + shortest(fit.map.orders[i].value());
        if (fit.map.form.directions == 1) {
            add_curves(fit, i, 1.0, order, fit.map.orders[i].value(), amplitude, phase);
        } else {
            add_curves(fit, i, 1.0, order + " forward", fit.map.orders[i].value(), amplitude, phase);
            add_curves(fit, i, -1.0, order + " backward", fit.map.orders[i].value(), amplitude, phase);
        }
    }
    return {"ripple-map", fmt::format("Ripple over speed: {}", source), "", {amplitude, phase}};
}

}  // namespace ripplenotch
