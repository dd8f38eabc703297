// SPDX-License-Identifier: MIT
#pragma once
// Where the ripple of a joint is, and who says so.

#include <compare>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "ripplenotch/core/quantity.hpp"

namespace ripplenotch {

/// Lines whose gear ratio nobody knows count by turns of the joint, as under a ratio of 1. A table or a map
/// of this ratio states none.
inline constexpr GearRatio no_ratio{1.0};

/// An order as it is typed: "2" counts by turns of the motor, "200/turn" by turns of the joint.
struct StatedOrder {
    double value = 0.0;
    bool per_turn = false;  ///< of the joint

    // Implicit: a bare number is an order of the motor.
    StatedOrder(double stated, bool by_joint = false) : value(stated), per_turn(by_joint) {}
    auto operator<=>(const StatedOrder&) const = default;
};

/// Throws UsageError, naming `what`, for a text that is neither, and for what is not above 0.
[[nodiscard]] StatedOrder parse_order(std::string_view text, std::string_view what);

/// The same of a list, "1:2:726/turn".
[[nodiscard]] std::vector<StatedOrder> parse_orders(std::string_view text, std::string_view what);

/// Orders by the shaft of this ratio, in their sequence. Throws UsageError, naming `what`, for an order by
/// the motor where no ratio is known.
[[nodiscard]] std::vector<Order> orders_under(const std::vector<StatedOrder>& stated,
                                              std::optional<GearRatio> ratio, std::string_view what);

/// As it is typed: "2"; "200/turn" without a ratio, and of an order that is no short number under it.
[[nodiscard]] std::string order_text(Order order, GearRatio ratio);
[[nodiscard]] std::string orders_text(const std::vector<Order>& orders, GearRatio ratio,
                                      std::string_view between);

/// For people: "order 2", "200/turn", "order 6 of the other spline (121)" of a line at n (ratio +/- 1).
[[nodiscard]] std::string order_in_words(Order order, GearRatio ratio);
/// "6/121", order 6 of the spline that has 121 turns: for a column. Empty for an order of the ratio itself.
[[nodiscard]] std::string order_on_other_spline(Order order, GearRatio ratio);

struct GearAccount {
    GearRatio ratio;            ///< no_ratio where `per_turn`; 0: not known
    std::vector<Order> orders;  ///< lowest first, each once; empty where other lines alone are asked for
    std::vector<double> amplitude_nm;  ///< one per order where all are known, else empty
    std::vector<double> phase_deg;     ///< the same; of cos(order * motor angle + phase)
    std::string source;                ///< "--gear-ratio, orders by default", "joint.json"
    bool per_turn = false;             ///< no ratio is known: the orders count by turns of the joint

    [[nodiscard]] bool has_ratio() const { return !per_turn && ratio.value() > 0.0; }
};

/// Orders of a gear whose ratio is known and whose orders nobody states: the motor turn and the two lobes of
/// the wave generator (Kim, Kim, Song 2011).
[[nodiscard]] inline std::vector<Order> default_orders() { return {Order(1.0), Order(2.0)}; }

}  // namespace ripplenotch
