// SPDX-License-Identifier: MIT
#include "filter/ripple/ripple_keys.hpp"

#include <algorithm>
#include <cmath>

#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"

namespace ripplenotch {

MotorAngle::Source angle_source(const Settings& settings) {
    return settings.text("angle") == "velocity" ? MotorAngle::Source::velocity : MotorAngle::Source::best;
}

double RippleOrders::hz(std::size_t line, double speed_deg_s) const noexcept {
    return orders[line] * gear_ratio * std::abs(speed_deg_s) / 360.0;
}

RippleOrders ripple_orders(std::string_view method, const Settings& settings) {
    RippleOrders ripple{settings.number("gear-ratio"), settings.list("orders")};
    std::vector<double> sorted = ripple.orders;
    std::sort(sorted.begin(), sorted.end());
    const auto twice = std::adjacent_find(sorted.begin(), sorted.end());
    if (twice != sorted.end())
        raise<UsageError>("method {}, orders: {} is given twice", method, shortest(*twice));
    return ripple;
}

std::vector<double> per_order(std::string_view method, const Settings& settings, std::string_view key,
                              const RippleOrders& orders, double otherwise) {
    if (!settings.has(key)) return std::vector<double>(orders.orders.size(), otherwise);
    std::vector<double> values = settings.list(key);
    if (values.size() != orders.orders.size()) {
        raise<UsageError>("method {}, {}: {} values for {} orders; give one for each, in the same sequence",
                          method, key, values.size(), orders.orders.size());
    }
    return values;
}

}  // namespace ripplenotch
