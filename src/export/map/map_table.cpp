// SPDX-License-Identifier: MIT
#include "export/map/map_table.hpp"

#include <cmath>
#include <numbers>
#include <utility>

#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {

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
