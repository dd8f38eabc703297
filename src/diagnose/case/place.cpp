// SPDX-License-Identifier: MIT
#include "diagnose/case/place.hpp"

#include <algorithm>
#include <cmath>
#include <string>

namespace ripplenotch {
namespace {

using Bins = std::vector<double>;

// Mean square of the torque in each bin of a quantity; nothing is known of bins with few samples.
Bins power_by(const std::vector<double>& quantity, const std::vector<double>& torque_nm, double low,
              double high, const PlaceRules& rules) {
    Bins power(rules.bins, 0.0), count(rules.bins, 0.0);
    const auto bins = static_cast<double>(rules.bins);
    for (std::size_t k = 0; k < quantity.size(); ++k) {
        const auto b =
            std::min(static_cast<std::size_t>((quantity[k] - low) / (high - low) * bins), rules.bins - 1);
        power[b] += torque_nm[k] * torque_nm[k];
        count[b] += 1.0;
    }
    for (std::size_t b = 0; b < rules.bins; ++b)
        power[b] = count[b] > rules.fewest_in_bin ? power[b] / count[b] : 0.0;
    return power;
}

// Where along a quantity the rms of the torque is at least half of its largest; empty when that is nowhere in
// particular, or the quantity hardly changes.
std::vector<Span> spans_along(const std::vector<double>& quantity, const std::vector<double>& torque_nm,
                              double least_range, const PlaceRules& rules) {
    const auto [low, high] = std::minmax_element(quantity.begin(), quantity.end());
    std::vector<Span> spans;
    if (!(*high - *low > least_range)) return spans;
    const Bins power = power_by(quantity, torque_nm, *low, *high, rules);
    const double most = *std::max_element(power.begin(), power.end());
    const double bins = static_cast<double>(rules.bins), width = (*high - *low) / bins;
    std::size_t taken = 0;
    for (std::size_t b = 0; b < rules.bins; ++b) {
        if (power[b] < rules.large_power * most || most == 0.0) continue;
        ++taken;
        const double from = *low + static_cast<double>(b) * width;
        if (b > 0 && power[b - 1] >= rules.large_power * most)
            spans.back().to = from + width;
        else
            spans.push_back({from, from + width});
    }
    if (static_cast<double>(taken) > rules.most_bins * bins) spans.clear();
    return spans;
}

Direction direction_of(const Case& c, const std::vector<double>& torque_nm, const PlaceRules& rules) {
    const std::vector<double>& velocity_deg_s = c.motion.velocity_deg_s;
    double moving[2] = {0.0, 0.0}, count[2] = {0.0, 0.0}, rest = 0.0, rests = 0.0;
    for (std::size_t k = 0; k < velocity_deg_s.size(); ++k) {
        const double v = velocity_deg_s[k], power = torque_nm[k] * torque_nm[k];
        if (std::abs(v) < c.moving_deg_s) {
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
    if (still >= rules.large_power * std::max(up, down)) return Direction::at_rest_too;
    if (up > rules.one_way_power * down) return Direction::positive;
    return down > rules.one_way_power * up ? Direction::negative : Direction::both;
}

}  // namespace

Place place_of(const Case& c, const std::vector<double>& torque_nm, const Term& term,
               const PlaceRules& rules) {
    Place place;
    place.time_s = spans_along(c.motion.time_s, torque_nm, 0.0, rules);
    place.speed_deg_s =
        spans_along(c.motion.velocity_deg_s, torque_nm, rules.least_speeds * c.moving_deg_s, rules);
    place.position_deg = spans_along(c.motion.position_deg, torque_nm, rules.least_travel_deg, rules);
    place.direction = direction_of(c, torque_nm, rules);
    for (std::size_t p = 0; p < term.values.size(); ++p) {
        if (!term.values[p]) continue;
        if (term.effect->ripple_order == p && *term.values[p] > 0.0) place.order.push_back(*term.values[p]);
        if (term.effect->parameters[p].name == "frequency_hz") place.hz.push_back(*term.values[p]);
    }
    return place;
}

}  // namespace ripplenotch
