// SPDX-License-Identifier: MIT
#include "diagnose/place.hpp"

#include <algorithm>
#include <cmath>

namespace ripplenotch {

Place place_of(const Case& c, const std::vector<double>& torque_nm, const Term& term) {
    // Bins in which the rms of what the term adds is at least half of the largest.
    Place place;
    const auto bins_of = [&](const std::vector<double>& quantity, double floor) {
        const auto [low, high] = std::minmax_element(quantity.begin(), quantity.end());
        constexpr std::size_t bins = 20;
        std::vector<double> power(bins, 0.0), count(bins, 0.0);
        std::vector<Span> spans;
        if (!(*high - *low > floor)) return spans;
        for (std::size_t k = 0; k < c.size(); ++k) {
            const auto b =
                std::min(static_cast<std::size_t>((quantity[k] - *low) / (*high - *low) * bins), bins - 1);
            power[b] += torque_nm[k] * torque_nm[k];
            count[b] += 1.0;
        }
        double most = 0.0;
        for (std::size_t b = 0; b < bins; ++b) {
            power[b] = count[b] > 20.0 ? power[b] / count[b] : 0.0;
            most = std::max(most, power[b]);
        }
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
        if (taken > bins * 3 / 4) spans.clear();  // nowhere in particular
        return spans;
    };
    place.time_s = bins_of(c.motion.time_s, 0.0);
    place.speed_deg_s = bins_of(c.motion.velocity_deg_s, 1.0);
    place.position_deg = bins_of(c.motion.position_deg, 5.0);
    double moving[2] = {0.0, 0.0}, count[2] = {0.0, 0.0}, rest = 0.0, rests = 0.0;
    for (std::size_t k = 0; k < c.size(); ++k) {
        const double v = c.motion.velocity_deg_s[k], power = torque_nm[k] * torque_nm[k];
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
    if (still < 0.25 * std::max(up, down))
        place.direction = up > 4.0 * down ? "positive" : down > 4.0 * up ? "negative" : "both";
    for (std::size_t p = 0; p < term.values.size(); ++p) {
        if (!term.values[p]) continue;
        if (term.effect->ripple_order == p && *term.values[p] > 0.0) place.order.push_back(*term.values[p]);
        if (term.effect->parameters[p].name == "frequency_hz") place.hz.push_back(*term.values[p]);
    }
    return place;
}

}  // namespace ripplenotch
