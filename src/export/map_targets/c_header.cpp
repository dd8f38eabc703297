// SPDX-License-Identifier: MIT
// The whole map as C99: constants and one function, without allocation, in bounded time.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include "export/code/map_code.hpp"
#include "export/code/method_code.hpp"
#include "export/map/map_target.hpp"
#include "export/run/maths.hpp"
#include "export/run/ripple_run.hpp"
#include "export/text.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/gear_account.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/design/running_design.hpp"

namespace ripplenotch {
namespace {

constexpr std::array keys = {name_key("ripple_map"), precision_key("of numbers and arithmetic")};

// The same map by turns of the joint where the angle within a turn of the motor does not do.
RippleMap as_coded(const RippleMap& map) {
    RippleMap coded = map;
    const bool whole = std::all_of(map.orders.begin(), map.orders.end(),
                                   [](Order order) { return order.value() == std::floor(order.value()); });
    if (whole || map.gear_ratio == no_ratio) return coded;
    if (map.form.second_comb != 0)
        raise<UsageError>(
            "target c-header: the map's second comb counts by turns of the motor, and not all orders are "
            "whole there");
    for (Order& order : coded.orders) order = Order(to_digits(order.value() * map.gear_ratio.value(), 12));
    coded.gear_ratio = no_ratio;
    return coded;
}

std::vector<double> orders_of(const RippleMap& map) {
    std::vector<double> orders;
    for (const Order order : map.orders) orders.push_back(order.value());
    return orders;
}

Written write(const RippleMap& whole, const Settings& settings, std::span<const std::string> heading) {
    const RippleMap map = as_coded(whole);
    const CodeStyle style = style_of(settings);
    const std::vector<double> orders = orders_of(map);
    const std::string body = fmt::format("\nenum {{ RN_ORDERS = {} }};\n", orders.size()) +
                             angles_code(orders, style) + std::string(runtime_text::angles) +
                             map_code(map, style) +
                             by_shaft(std::string(runtime_text::map_torque), orders, map.gear_ratio);
    return {style.header(heading, body), {}};
}

LoadedMap read(std::string_view bytes, const std::string& source, const RippleMap& whole,
               const Settings& settings) {
    const RippleMap map = as_coded(whole);
    const CodeStyle style = style_of(settings);
    TextReader reader(bytes, source, Comments::c, style.precision());
    const std::vector<double> orders = style.read(reader, "orders", map.orders.size());
    const MapTables tables(reader, map, style);
    return in_precision(style.precision(), [&](auto math) -> LoadedMap {
        const auto run = std::make_shared<RippleRun<decltype(math)>>(orders, &map, tables);
        return {style.is_float ? "float32" : "float64", map,
                [run, ratio = map.gear_ratio.value(), zero_deg = map.zero_deg,
                 within_turn = repeats_each_turn(orders)](const MapState& state) {
                    const double turns = ratio * (state.position_deg - zero_deg) / 360.0;
                    return run->torque({0.0, state.speed_deg_s,
                                        within_turn ? turns - std::floor(turns) : turns, state.position_deg});
                }};
    });
}

}  // namespace

const MapTarget map_target_list::c_header = {
    .name = "c-header",
    .summary = "the whole map as C99: one function, no allocation",
    .source = "ISO/IEC 9899:1999",
    .endings = ".h .hpp",
    .keys = keys,
    .write = write,
    .read = read,
};

}  // namespace ripplenotch
