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
#include "export/run/map_run.hpp"
#include "export/text.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/gear_account.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/design/running_design.hpp"

namespace ripplenotch {
namespace {

constexpr std::array keys = {name_key("ripple_map"), precision_key("of numbers and arithmetic")};

constexpr std::string_view torque_code = R"c(
/* Ripple of the joint's torque in Nm: subtract it from the sensor. motor_turns: the @shaft@'s angle in turns, 0 where the
   joint is at the map's zero; @fraction@. joint_deg: the joint's position; only for the second
   comb. */
static inline @real@ @name@_torque(@real@ speed_deg_s, @real@ motor_turns, @real@ joint_deg) {
)c";

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
    const MapCode code(map, style);
    const std::vector<double> orders = orders_of(map);
    std::string body = style.array("orders", orders) + std::string(turn_code(style.is_float)) +
                       code.definitions() + std::string(torque_code) + code.amplitudes_here();
    std::vector<std::pair<std::string, std::string>> products;
    for (std::size_t i = 1; i < 2 * orders.size(); ++i)
        products.emplace_back(fmt::format("z[{}]", i), fmt::format("{}{}", i % 2 == 0 ? 'c' : 's', i / 2));
    body += order_angles_code(orders, "motor_turns") + "    return " + sum_code("z[0] * c0", products);
    return {style.header(heading, by_shaft(body, orders, map.gear_ratio) + ";\n}\n"), {}};
}

// The header's function, operation by operation.
template <class Real>
class TorqueRun {
  public:
    TorqueRun(const RippleMap& map, const std::vector<double>& orders, const MapTables& tables)
        : orders_(orders.begin(), orders.end()),
          shows_(2 * orders.size()),
          map_(map, tables),
          ratio_(map.gear_ratio.value()),
          zero_deg_(map.zero_deg),
          within_turn_(repeats_each_turn(orders)) {}

    double operator()(const MapState& state) {
        const double turns = ratio_ * (state.position_deg - zero_deg_) / 360.0;
        order_angles(orders_, static_cast<Real>(within_turn_ ? turns - std::floor(turns) : turns), shows_);
        const auto& z = map_.at({0.0, state.speed_deg_s, turns, state.position_deg});
        Real ripple = 0;
        for (std::size_t i = 0; i < shows_.size(); ++i) ripple += z[i] * shows_[i];
        return static_cast<double>(ripple);
    }

  private:
    std::vector<Real> orders_, shows_;
    MapRun<Real> map_;
    double ratio_, zero_deg_;
    bool within_turn_;
};

LoadedMap read(std::string_view bytes, const std::string& source, const RippleMap& whole,
               const Settings& settings) {
    const RippleMap map = as_coded(whole);
    const CodeStyle style = style_of(settings);
    TextReader reader(bytes, source, Comments::c, style.precision());
    const std::vector<double> orders = style.read(reader, "orders", map.orders.size());
    const MapTables tables(reader, map, style);
    return in_precision(style.precision(), [&](auto real) -> LoadedMap {
        const auto run = std::make_shared<TorqueRun<decltype(real)>>(map, orders, tables);
        return {style.is_float ? "float32" : "float64", map,
                [run](const MapState& state) { return (*run)(state); }};
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
