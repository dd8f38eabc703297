// SPDX-License-Identifier: MIT
#include "filter/ripple_keys.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/gear_account.hpp"
#include "ripplenotch/core/number.hpp"

namespace ripplenotch {

namespace {

constexpr double slow_turns = 0.002;      ///< turns of the motor in a sample
constexpr double judged_samples = 100.0;  ///< averaging length for the test of position noise
constexpr double fewest_judged = 6.0;     ///< before which the velocity is taken while slow
constexpr double still_turns = 1e-5;      ///< position noise below this is none
constexpr double pull_turns = 2e-5;       ///< correction by a noisy position at standstill

}  // namespace

void MotorAngle::restart() noexcept {
    started_ = false;
    from_velocity_ = false;
}

void MotorAngle::next(double velocity_deg_s, const double* position_deg, double correction_deg_s) noexcept {
    if (!started_) {
        started_ = true;
        from_velocity_ = position_deg == nullptr || source_ == Source::velocity;
        joint_deg_ = position_deg != nullptr ? *position_deg : start_deg_;
        step_turns_ = 0.0;
        ahead_deg_ = beside_ = covariance_ = excess_ = slow_speed_ = judged_ = 0.0;
    } else {
        const double by_velocity = 0.5 * (last_velocity_ + velocity_deg_s) * step_s_;
        double moved = by_velocity + correction_deg_s * step_s_;
        from_velocity_ = from_velocity_ || position_deg == nullptr;
        if (!from_velocity_ && position_deg != nullptr) {
            double by_position = *position_deg - last_position_;
            if (std::abs(by_position) > 180.0) by_position -= 360.0 * std::round(by_position / 360.0);
            moved = follow(by_velocity, by_position);
        }
        joint_deg_ += moved;
        step_turns_ = gear_ratio_ * moved / 360.0;
    }
    last_velocity_ = velocity_deg_s;
    if (position_deg != nullptr) last_position_ = *position_deg;
}

// Variance of the position about where the motor is, in motor turns squared. White noise of a position shows
// in its difference from the velocity as a covariance of minus its variance from sample to sample; noise of
// the velocity does not. A position in steps of q stands and jumps, with mean square q v at the speed v.
double MotorAngle::trembling() const noexcept {
    const double steps = slow_speed_ > 0.0 ? excess_ / slow_speed_ : 0.0;
    const double of_steps = excess_ > 0.0 ? std::min(steps * steps / 12.0, 10.0 * excess_) : 0.0;
    return std::max({-covariance_, of_steps, 0.0});
}

// The assumed motion of the joint: to the measured position, or, while the position noise exceeds the motor's
// motion, by the velocity and a share of the way to the position.
double MotorAngle::follow(double by_velocity_deg, double by_position_deg) noexcept {
    const double to_turns = gear_ratio_ / 360.0;
    const double turned = std::abs(by_velocity_deg * to_turns);
    const double before = beside_;
    beside_ = (by_position_deg - by_velocity_deg) * to_turns;
    if (turned < slow_turns) {
        judged_ = std::min(judged_ + 1.0, judged_samples);
        covariance_ += (beside_ * before - covariance_) / judged_;
        excess_ += (beside_ * beside_ - 4.0 * turned * turned - excess_) / judged_;
        slow_speed_ += (turned - slow_speed_) / judged_;
    }
    ahead_deg_ += by_position_deg;
    double moved = ahead_deg_;
    const double trembles = trembling();
    if (turned < slow_turns && judged_ < fewest_judged) {
        moved = by_velocity_deg;
    } else if (trembles > still_turns * still_turns) {
        // The velocity is trusted to half of its value: clocks jitter by as much.
        const double sure = 0.25 * turned * turned + pull_turns * pull_turns;
        moved = by_velocity_deg + sure / (sure + trembles) * (ahead_deg_ - by_velocity_deg);
    }
    ahead_deg_ -= moved;
    return moved;
}

MotorAngle::Source angle_source(const Settings& settings) {
    return settings.text("angle") == "velocity" ? MotorAngle::Source::velocity : MotorAngle::Source::best;
}

RippleOrders RippleOrders::by_lowest() const {
    if (lowest() == 1.0) return *this;
    const double first = lowest() * gear_ratio;
    RippleOrders counted{first, orders};
    for (double& order : counted.orders) order = order * gear_ratio / first;
    return counted;
}

RippleOrders RippleOrders::by_joint() const {
    RippleOrders counted{no_ratio.value(), orders};
    for (double& order : counted.orders) order = to_digits(order * gear_ratio, 12);
    return counted;
}

RippleOrders ripple_orders(std::string_view method, const Settings& settings) {
    const std::string what = fmt::format("method {}, orders", method);
    std::optional<GearRatio> ratio;
    if (settings.has("gear-ratio")) ratio = GearRatio(settings.number("gear-ratio"));
    RippleOrders ripple{ratio.value_or(no_ratio).value(), {}};
    for (const Order order : orders_under(parse_orders(settings.text("orders"), what), ratio, what))
        ripple.orders.push_back(order.value());
    std::vector<double> sorted = ripple.orders;
    std::sort(sorted.begin(), sorted.end());
    const auto twice = std::adjacent_find(sorted.begin(), sorted.end());
    if (twice != sorted.end())
        raise<UsageError>("{}: {} is given twice", what,
                          order_text(Order(*twice), GearRatio(ripple.gear_ratio)));
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
