// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "ripplenotch/analysis/amplitude_by_speed.hpp"
#include "ripplenotch/analysis/ripple_estimate.hpp"
#include "ripplenotch/analysis/verdict_sentence.hpp"
#include "ripplenotch/verdict/other_motors.hpp"
#include "ripplenotch/verdict/readings.hpp"

namespace ripplenotch {

namespace {

// The amplitudes are those of estimate_ripple, as everywhere, over the angle of the other motor.
OtherMotorRipple other_ripple(const MapFit& fit, const OtherMotor& motor,
                              std::span<const std::vector<double>> torques_nm) {
    OtherMotorRipple ripple{motor.joint, motor.gear.ratio, {}, fit.doubt};
    std::vector<TraceView> logs = motor.motion;
    for (std::size_t l = 0; l < logs.size(); ++l) logs[l].torque_nm = torques_nm[l];
    std::vector<Order> found;
    for (const MapOrderScore& score : fit.scores)
        if (score.in_map) found.emplace_back(score.order);
    const std::vector<RippleEstimate> estimates = estimate_ripple(logs, motor.gear.ratio, found);
    auto next = estimates.begin();
    for (const MapOrderScore& score : fit.scores) {
        OtherMotorRipple::AtOrder& at = ripple.orders.emplace_back();
        at.order = score.order;
        at.found = score.in_map;
        if (score.in_map) {
            at.amplitude_nm = next->amplitude_nm;
            at.standard_error_nm = next->standard_error_nm;
            ++next;
        } else if (std::isfinite(score.detectable_nm) && score.detectable_nm > 0.0) {
            at.detectable_nm = score.detectable_nm;
        }
    }
    return ripple;
}

// Both splines give lines one output order apart, which segments of eight motor turns cannot separate: they
// are one ripple here, at the order of the stronger one.
std::vector<Order> separable_orders(const Identification& found) {
    std::vector<Order> orders;  // of the strongest line first
    for (const Line& line : found.lines) {
        const auto order = motor_order(line);
        const auto is_near = [&](Order other) {
            return std::abs(other.value() - *order) < ripple_resolution_orders;
        };
        if (order && std::none_of(orders.begin(), orders.end(), is_near)) orders.emplace_back(*order);
    }
    std::sort(orders.begin(), orders.end());
    return orders;
}

}  // namespace

void add_amplitudes(Identification& found, std::span<const Log> logs, std::optional<GearRatio> stated) {
    const bool known = found.gear_ratio.value.has_value();
    if (!found.doubts.empty() || (!known && !stated)) return;
    std::vector<TraceView> views;
    for (const Log& log : logs) views.push_back(log.trace.view());
    found.by_speed =
        known ? amplitude_by_speed(views, GearRatio(*found.gear_ratio.value), separable_orders(found))
              : amplitude_by_speed(views, *stated, default_orders());
}

Identification identify_among(std::span<const Log> logs, Identification alone, const OtherMotors& others,
                              const IdentifyOptions& options) {
    if (others.motors.empty() || !alone.doubts.empty()) {
        alone.other_motors_not_known = others.not_known;
        return alone;
    }
    std::vector<TraceView> views;
    for (const Log& log : logs) views.push_back(log.trace.view());
    const std::optional<GearAccount> own = found_gear(alone);
    const MapFit fit = fit_joint_map(views, own ? &*own : nullptr, others.motors, others.pairs());
    Identification found = std::move(alone);
    if (!fit.map.others.empty()) {
        std::vector<Log> less(logs.begin(), logs.end());
        std::vector<std::vector<double>> torques = without_other_motors(views, fit.map, others.motors);
        for (std::size_t l = 0; l < less.size(); ++l) less[l].trace.torque_nm = std::move(torques[l]);
        std::string joint = std::move(found.joint);
        found = identify_readings(less, options);
        add_amplitudes(found, less, options.hint);
        found.joint = std::move(joint);
    }
    for (std::size_t j = 0; j < others.motors.size(); ++j) {
        RippleMap rest = fit.map;
        std::erase_if(rest.others, [&](const RippleMap& one) { return one.joint == others.motors[j].joint; });
        std::vector<std::vector<double>> torques = without_other_motors(views, rest, others.motors);
        for (std::size_t l = 0; l < logs.size() && !rest.orders.empty(); ++l) {
            const std::vector<double> ripple = map_along(rest, views[l]);
            for (std::size_t k = 0; k < ripple.size(); ++k) torques[l][k] -= ripple[k];
        }
        found.other_motors.push_back(other_ripple(fit.others[j], others.motors[j], torques));
    }
    found.other_motors_not_known = others.not_known;
    if (const std::string words = other_motors_sentence(found); !words.empty()) found.verdict += " " + words;
    return found;
}

}  // namespace ripplenotch
