// SPDX-License-Identifier: MIT
#include "export/map/map_table.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <utility>

#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/gear_account.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {

RippleMap flat_map(const RippleMap& map, const Settings& settings) {
    RippleMap flat = map;
    flat.form = {};
    flat.form.speeds_deg_s = {map.speeds_deg_s.middle()};
    const double speed = settings.has("speed") ? settings.number("speed") : map.speeds_deg_s.middle();
    const std::string direction = settings.text("direction");
    // The mean over the joint's turn is the map without the second comb.
    RippleMap still = map;
    for (auto& values : still.values)
        for (std::size_t c = 0; c < values.size(); ++c)
            if (map.form.is_second_comb(c)) values[c] = 0.0;
    std::vector<double> weights(map.form.columns());
    for (std::size_t i = 0; i < map.orders.size(); ++i) {
        std::complex<double> sum = 0.0;
        for (const double sign : {1.0, -1.0}) {
            if (direction == (sign > 0.0 ? "backward" : "forward")) continue;
            map_weights(still, {sign * speed, map.positions_deg.middle()}, weights);
            sum += map_amplitude(still, i, weights, map.positions_deg.middle());
        }
        if (map.orders[i].value() != std::floor(map.orders[i].value())) sum = 0.0;
        flat.values[i] = {direction == "both" ? 0.5 * sum : sum};
    }
    return flat;
}

std::vector<std::string> flattened(const RippleMap& map, std::string_view target) {
    if (map.gear_ratio == no_ratio)
        raise<UsageError>(
            "target {} counts by turns of the motor, and the map states no gear ratio: make it with "
            "--gear-ratio, or use fourier or c-header",
            target);
    std::vector<std::string> warnings;
    const auto lost = [&](bool is, std::string_view what) {
        if (is) warnings.push_back(fmt::format("{} holds one amplitude an order: {} left out", target, what));
    };
    lost(map.form.speeds_deg_s.size() > 1, "the dependence on speed is");
    lost(map.form.directions > 1, "the dependence on direction is");
    lost(map.form.second_comb != 0, "the second comb is");
    for (const Order order : map.orders)
        lost(order.value() != std::floor(order.value()), order_in_words(order, map.gear_ratio) + " is");
    return warnings;
}

// z = r exp(-i phase).
AmplitudePhase amplitude_phase(std::complex<double> value) {
    double phase = -portable::arg(value) * degrees_per_radian;
    if (phase < 0.0) phase += 360.0;
    return {portable::hypot(value.real(), value.imag()), phase};
}

std::complex<double> value_of(const AmplitudePhase& one) {
    return {one.amplitude_nm * portable::cos_degrees(one.phase_deg),
            -one.amplitude_nm * portable::sin_degrees(one.phase_deg)};
}

std::vector<double> turn_table(const RippleMap& flat, std::size_t entries) {
    std::vector<double> table(entries);
    for (std::size_t k = 0; k < entries; ++k) {
        const double turns = static_cast<double>(k) / static_cast<double>(entries);
        for (std::size_t i = 0; i < flat.orders.size(); ++i) {
            const double cycles = flat.orders[i].value() * turns;
            const double phase = 2.0 * std::numbers::pi * (cycles - std::floor(cycles));
            table[k] += flat.values[i][0].real() * portable::cos(phase) +
                        flat.values[i][0].imag() * portable::sin(phase);
        }
    }
    return table;
}

double interpolation_bound_nm(const RippleMap& flat, std::size_t entries) {
    double bound = 0.0;
    for (std::size_t i = 0; i < flat.orders.size(); ++i) {
        const double step = 2.0 * std::numbers::pi * flat.orders[i].value() / static_cast<double>(entries);
        const std::complex<double> z = flat.values[i][0];
        bound += portable::hypot(z.real(), z.imag()) * step * step / 8.0;
    }
    return bound;
}

std::function<double(const MapState&)> table_torque(std::vector<double> table, const RippleMap& map) {
    const double ratio = map.gear_ratio.value(), zero = map.zero_deg;
    return [table = std::move(table), ratio, zero](const MapState& state) {
        const double turns = ratio * (state.position_deg - zero) / 360.0;
        const auto size = static_cast<float>(table.size());
        const float place = static_cast<float>(turns - std::floor(turns)) * size;
        const auto below = static_cast<std::size_t>(place) % table.size();
        const float along = place - std::floor(place);
        const auto from = static_cast<float>(table[below]),
                   to = static_cast<float>(table[(below + 1) % table.size()]);
        return static_cast<double>(from + along * (to - from));
    };
}

}  // namespace ripplenotch
