// SPDX-License-Identifier: MIT
#include "ripplenotch/core/gear_account.hpp"

#include <fmt/format.h>

#include <cmath>

#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/spec.hpp"
#include "ripplenotch/core/visible_text.hpp"

namespace ripplenotch {
namespace {

constexpr std::string_view per_turn_mark = "/turn";
constexpr double highest_order = 1e4, highest_per_turn = 1e6;  // chosen, not derived
constexpr std::size_t short_text = 6;                          ///< characters of a number that people type

}  // namespace

StatedOrder parse_order(std::string_view text, std::string_view what) {
    const bool per_turn = text.ends_with(per_turn_mark);
    const std::string_view number = text.substr(0, text.size() - (per_turn ? per_turn_mark.size() : 0));
    const auto value = parse_number(number);
    if (!value || !std::isfinite(*value))
        raise<UsageError>(
            "{}: '{}' is no order: 2 is twice per turn of the motor, 200/turn is 200 times per turn of the "
            "joint",
            what, text);
    if (!(*value > 0.0)) raise<UsageError>("{}: {} is not above 0", what, text);
    const double most = per_turn ? highest_per_turn : highest_order;
    if (*value > most)
        raise<UsageError>("{}: {} is above the limit of {}{}", what, text, shortest(most),
                          per_turn ? per_turn_mark : "");
    return {*value, per_turn};
}

std::vector<StatedOrder> parse_orders(std::string_view text, std::string_view what) {
    std::vector<StatedOrder> orders;
    for (const std::string_view piece : split(text, ':')) orders.push_back(parse_order(piece, what));
    return orders;
}

std::vector<Order> orders_under(const std::vector<StatedOrder>& stated, std::optional<GearRatio> ratio,
                                std::string_view what) {
    std::vector<Order> orders;
    for (const StatedOrder& one : stated) {
        if (!ratio && !one.per_turn)
            raise<UsageError>(
                "{}: {} counts by turns of the motor, which takes a gear ratio; give --gear-ratio, for "
                "example 100, or count by turns of the joint: {}/turn",
                what, shortest(one.value), shortest(100.0 * one.value));
        orders.emplace_back(one.per_turn && ratio ? one.value / ratio->value() : one.value);
    }
    return orders;
}

std::string order_text(Order order, GearRatio ratio) {
    const std::string as_is = shortest(order.value());
    if (ratio == no_ratio) return as_is + std::string(per_turn_mark);
    if (as_is.size() <= short_text) return as_is;
    return fmt::format("{:.6g}{}", order.value() * ratio.value(), per_turn_mark);
}

std::string orders_text(const std::vector<Order>& orders, GearRatio ratio, std::string_view between) {
    return joined(orders, between, [ratio](Order order) { return order_text(order, ratio); });
}

std::string order_on_other_spline(Order order, GearRatio ratio) {
    constexpr double apart = 0.25;  ///< of the distance between the two combs
    if (ratio == no_ratio || !order_text(order, ratio).ends_with(per_turn_mark)) return "";
    for (const double side : {1.0, -1.0}) {
        const double teeth = ratio.value() + side, n = std::round(order.value() * ratio.value() / teeth);
        if (n > 0.0 && std::abs(order.value() * ratio.value() / teeth - n) * teeth < apart * n)
            return fmt::format("{}/{:.3g}", shortest(n), teeth);
    }
    return "";
}

std::string order_in_words(Order order, GearRatio ratio) {
    const std::string text = order_text(order, ratio), other = order_on_other_spline(order, ratio);
    if (const std::size_t slash = other.find('/'); slash != std::string::npos)
        return fmt::format("order {} of the other spline ({})", other.substr(0, slash),
                           other.substr(slash + 1));
    if (!text.ends_with(per_turn_mark)) return "order " + text;
    return fmt::format("{:.5g}{}", order.value() * (ratio == no_ratio ? 1.0 : ratio.value()), per_turn_mark);
}

}  // namespace ripplenotch
