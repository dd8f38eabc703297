// SPDX-License-Identifier: MIT
#include "diagnose/place.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

namespace ripplenotch {
namespace {

constexpr std::size_t bins = 20;
using Bins = std::array<double, bins>;

// Mean square of the torque in each bin of a quantity; nothing is known of bins with few samples.
Bins power_by(const std::vector<double>& quantity, const std::vector<double>& torque_nm, double low,
              double high) {
    Bins power{}, count{};
    for (std::size_t k = 0; k < quantity.size(); ++k) {
        const auto b =
            std::min(static_cast<std::size_t>((quantity[k] - low) / (high - low) * bins), bins - 1);
        power[b] += torque_nm[k] * torque_nm[k];
        count[b] += 1.0;
    }
    for (std::size_t b = 0; b < bins; ++b) power[b] = count[b] > 20.0 ? power[b] / count[b] : 0.0;
    return power;
}

// Where along a quantity the rms of the torque is at least half of its largest; empty when that is nowhere in
// particular, or the quantity hardly changes.
std::vector<Span> spans_along(const std::vector<double>& quantity, const std::vector<double>& torque_nm,
                              double least_range) {
    const auto [low, high] = std::minmax_element(quantity.begin(), quantity.end());
    std::vector<Span> spans;
    if (!(*high - *low > least_range)) return spans;
    const Bins power = power_by(quantity, torque_nm, *low, *high);
    const double most = *std::max_element(power.begin(), power.end());
    const double width = (*high - *low) / bins;
    std::size_t taken = 0;
    for (std::size_t b = 0; b < bins; ++b) {
        if (power[b] < 0.25 * most || most == 0.0) continue;
        ++taken;
        const double from = *low + static_cast<double>(b) * width;
        if (b > 0 && power[b - 1] >= 0.25 * most)
            spans.back().to = from + width;
        else
            spans.push_back({from, from + width});
    }
    if (taken > bins * 3 / 4) spans.clear();
    return spans;
}

// Empty for what acts at rest as well.
std::string direction_of(const std::vector<double>& velocity_deg_s, const std::vector<double>& torque_nm) {
    double moving[2] = {0.0, 0.0}, count[2] = {0.0, 0.0}, rest = 0.0, rests = 0.0;
    for (std::size_t k = 0; k < velocity_deg_s.size(); ++k) {
        const double v = velocity_deg_s[k], power = torque_nm[k] * torque_nm[k];
        if (std::abs(v) < 1.0) {
            rest += power;
            rests += 1.0;
        } else {
            moving[v > 0.0] += power;
            count[v > 0.0] += 1.0;
        }
    }
    const double up = count[1] > 0.0 ? moving[1] / count[1] : 0.0,
                 down = count[0] > 0.0 ? moving[0] / count[0] : 0.0;
    const double still = rests > 0.0 ? rest / rests : 0.0;
    if (still >= 0.25 * std::max(up, down)) return "";
    return up > 4.0 * down ? "positive" : down > 4.0 * up ? "negative" : "both";
}

}  // namespace

Place place_of(const Case& c, const std::vector<double>& torque_nm, const Term& term) {
    Place place;
    place.time_s = spans_along(c.motion.time_s, torque_nm, 0.0);
    place.speed_deg_s = spans_along(c.motion.velocity_deg_s, torque_nm, 1.0);
    place.position_deg = spans_along(c.motion.position_deg, torque_nm, 5.0);
    place.direction = direction_of(c.motion.velocity_deg_s, torque_nm);
    for (std::size_t p = 0; p < term.values.size(); ++p) {
        if (!term.values[p]) continue;
        if (term.effect->ripple_order == p && *term.values[p] > 0.0) place.order.push_back(*term.values[p]);
        if (term.effect->parameters[p].name == "frequency_hz") place.hz.push_back(*term.values[p]);
    }
    return place;
}

}  // namespace ripplenotch
