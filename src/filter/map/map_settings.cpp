// SPDX-License-Identifier: MIT
#include "filter/map/map_settings.hpp"

#include <algorithm>
#include <utility>

#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/gear_account.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/visible_text.hpp"
#include "ripplenotch/filter/map_fit.hpp"
#include "ripplenotch/filter/method.hpp"

namespace ripplenotch {

namespace {

MapRange range_of(const Settings& settings, std::string_view key) {
    if (!settings.has(key)) return {};
    const std::vector<double> ends = settings.list(key);
    return {*std::min_element(ends.begin(), ends.end()), *std::max_element(ends.begin(), ends.end())};
}

std::string list_text(const std::vector<double>& values) { return joined(values, ":"); }

std::string ends_text(const MapRange& range) { return list_text({range.from, range.to}); }

}  // namespace

RippleOrders counted_orders(std::string_view method, const Settings& settings) {
    const RippleOrders stated = ripple_orders(method, settings);
    return settings.number("second-comb") == 0.0 ? stated.by_lowest() : stated;
}

std::optional<RippleMap> map_of(std::string_view method, const Settings& settings,
                                const RippleOrders& ripple) {
    if (!settings.has("cosines") && !settings.has("sines")) return std::nullopt;
    RippleMap map;
    map.gear_ratio = GearRatio(ripple.gear_ratio);
    for (const double order : ripple.orders) map.orders.emplace_back(order);
    MapForm& form = map.form;
    if (settings.has("speeds")) form.speeds_deg_s = settings.list("speeds");
    if (!std::is_sorted(form.speeds_deg_s.begin(), form.speeds_deg_s.end(), std::less_equal<>()))
        raise<UsageError>("method {}, speeds: each has to be above the one before", method);
    form.directions = static_cast<std::size_t>(settings.number("directions"));
    form.second_comb = static_cast<int>(settings.number("second-comb"));
    if (form.second_comb != 0 && !settings.has("gear-ratio"))
        raise<UsageError>("method {}, second-comb: it takes a gear-ratio", method);
    map.speeds_deg_s = {settings.number("slowest"), form.speeds_deg_s.back()};
    map.positions_deg = range_of(settings, "positions");
    const std::size_t columns = form.columns(), wanted = columns * ripple.orders.size();
    for (const std::string_view key : {"cosines", "sines"}) {
        const std::size_t given = settings.has(key) ? settings.list(key).size() : 0;
        if (given == wanted) continue;
        raise<UsageError>("method {}, {}: {} values, and {} orders of {} take {}", method, key, given,
                          ripple.orders.size(), columns, wanted);
    }
    const std::vector<double> cosines = settings.list("cosines"), sines = settings.list("sines");
    for (std::size_t i = 0; i < ripple.orders.size(); ++i) {
        map.values.emplace_back();
        for (std::size_t c = i * columns; c < (i + 1) * columns; ++c)
            map.values.back().emplace_back(cosines[c], sines[c]);
    }
    map.spread_nm = per_order(method, settings, "spread", ripple, 0.0);
    return map;
}

// MapRunner: the amplitudes of each order here, and its phase; that of the joint, too, for a second comb.
double map_multiplications(const Settings& settings) {
    if (!settings.has("cosines")) return 0.0;
    const auto orders = static_cast<double>(parse_orders(settings.text("orders"), "orders").size());
    const auto values = static_cast<double>(settings.list("cosines").size());
    constexpr double of_order = 6.0 + circle_multiplications, of_comb = 8.0 + circle_multiplications;
    constexpr double of_sample = 8.0;
    return of_sample + 2.0 * values +
           orders * (of_order + (settings.number("second-comb") != 0.0 ? of_comb : 0.0));
}

std::vector<std::pair<std::string, std::string>> map_as_keys(const RippleMap& fitted) {
    const RippleMap map = with_zero(fitted, 0.0);
    std::vector<double> cosines, sines;
    for (const auto& values : map.values) {
        for (const std::complex<double>& z : values) {
            cosines.push_back(z.real());
            sines.push_back(z.imag());
        }
    }
    std::vector<std::pair<std::string, std::string>> keys = {
        {"orders", orders_text(map.orders, map.gear_ratio, ":")},
        {"cosines", list_text(cosines)},
        {"sines", list_text(sines)},
        {"speeds", list_text(map.form.speeds_deg_s)},
        {"directions", std::to_string(map.form.directions)},
        {"slowest", shortest(map.speeds_deg_s.from)},
        {"positions", ends_text(map.positions_deg)},
        {"spread", list_text(map.spread_nm)}};
    if (map.gear_ratio != no_ratio)
        keys.insert(keys.begin(), {"gear-ratio", shortest(map.gear_ratio.value())});
    if (map.form.second_comb != 0) keys.emplace_back("second-comb", std::to_string(map.form.second_comb));
    if (map.speeds_deg_s.to > 0.0) keys.emplace_back("fastest", shortest(map.speeds_deg_s.to));
    return keys;
}

}  // namespace ripplenotch
