// SPDX-License-Identifier: MIT
#include "filter/map/map_settings.hpp"

#include <algorithm>
#include <utility>

#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/visible_text.hpp"
#include "ripplenotch/filter/map_fit.hpp"

namespace ripplenotch {

namespace {

MapRange range_of(const Settings& settings, std::string_view key) {
    if (!settings.has(key)) return {};
    const std::vector<double> ends = settings.list(key);
    return {*std::min_element(ends.begin(), ends.end()), *std::max_element(ends.begin(), ends.end())};
}

std::string list_text(const std::vector<double>& values) { return joined(values, ":"); }

std::string ends_text(const MapRange& range) { return list_text({range.from, range.to}); }

std::size_t whole_value(const Settings& settings, std::string_view key) {
    return static_cast<std::size_t>(settings.number(key));
}

}  // namespace

RippleMap StatedMap::at_temperature() const {
    if (!map.form.by_temperature) return map;
    RippleMap there = map;
    there.form.by_temperature = false;
    const MapRange& seen = map.temperatures_degc;
    const double warmer = std::clamp(degc, seen.from, seen.to) - seen.middle();
    const std::size_t each = map.form.columns_a_direction(), last = map.form.temperature_column();
    for (std::vector<std::complex<double>>& values : there.values) {
        for (std::size_t d = map.form.directions; d-- > 0;) {
            const auto from = values.begin() + static_cast<std::ptrdiff_t>(d * each);
            for (std::size_t k = 0; k < map.form.speeds_deg_s.size(); ++k) from[k] += warmer * from[last];
            values.erase(from + static_cast<std::ptrdiff_t>(last));
        }
    }
    return there;
}

std::optional<StatedMap> map_of(std::string_view method, const Settings& settings,
                                const RippleOrders& ripple) {
    if (!settings.has("cosines") && !settings.has("sines")) return std::nullopt;
    RippleMap map;
    map.gear_ratio = GearRatio(ripple.gear_ratio);
    for (const double order : ripple.orders) map.orders.emplace_back(order);
    MapForm& form = map.form;
    if (settings.has("speeds")) form.speeds_deg_s = settings.list("speeds");
    if (!std::is_sorted(form.speeds_deg_s.begin(), form.speeds_deg_s.end(), std::less_equal<>()))
        raise<UsageError>("method {}, speeds: each has to be above the one before", method);
    form.directions = whole_value(settings, "directions");
    form.turn_harmonics = whole_value(settings, "turn-harmonics");
    form.second_comb = static_cast<int>(settings.number("second-comb"));
    form.by_load = settings.number("by-load") > 0.0;
    form.by_temperature = settings.number("by-temperature") > 0.0;
    map.speeds_deg_s = {settings.number("slowest"), form.speeds_deg_s.back()};
    map.positions_deg = range_of(settings, "positions");
    map.loads_nm = range_of(settings, "loads");
    map.temperatures_degc = range_of(settings, "temperatures");
    if (form.by_temperature && !settings.has("temperatures"))
        raise<UsageError>("method {}: by-temperature=1 needs temperatures, the least and the greatest",
                          method);
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
    StatedMap stated{std::move(map)};
    if (!stated.map.form.by_temperature) return stated;
    if (!settings.has("temperature"))
        raise<UsageError>(
            "method {}: its map depends on the joint's temperature, which is not stated; state it in degC, "
            "temperature=31",
            method);
    stated.degc = settings.number("temperature");
    stated.follows_rows = settings.text("temperature-of") == "rows";
    return stated;
}

std::vector<std::pair<std::string, std::string>> map_as_keys(const RippleMap& fitted) {
    const RippleMap map = with_zero(fitted, 0.0);
    std::vector<double> orders, cosines, sines;
    for (const Order order : map.orders) orders.push_back(order.value());
    for (const auto& values : map.values) {
        for (const std::complex<double>& z : values) {
            cosines.push_back(z.real());
            sines.push_back(z.imag());
        }
    }
    const std::string ratio = shortest(map.gear_ratio.value());
    std::vector<std::pair<std::string, std::string>> keys = {
        {"gear-ratio", ratio},
        {"orders", list_text(orders)},
        {"cosines", list_text(cosines)},
        {"sines", list_text(sines)},
        {"speeds", list_text(map.form.speeds_deg_s)},
        {"directions", std::to_string(map.form.directions)},
        {"turn-harmonics", std::to_string(map.form.turn_harmonics)},
        {"by-load", map.form.by_load ? "1" : "0"},
        {"slowest", shortest(map.speeds_deg_s.from)},
        {"positions", ends_text(map.positions_deg)},
        {"loads", ends_text(map.loads_nm)},
        {"spread", list_text(map.spread_nm)}};
    if (map.form.by_temperature) {
        keys.emplace_back("by-temperature", "1");
        keys.emplace_back("temperatures", ends_text(map.temperatures_degc));
    }
    if (map.form.second_comb != 0) keys.emplace_back("second-comb", std::to_string(map.form.second_comb));
    if (map.speeds_deg_s.to > 0.0) keys.emplace_back("fastest", shortest(map.speeds_deg_s.to));
    return keys;
}

}  // namespace ripplenotch
