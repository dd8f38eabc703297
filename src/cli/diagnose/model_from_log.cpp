// SPDX-License-Identifier: MIT
#include "cli/diagnose/model_from_log.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "cli/gear/gear_choice.hpp"
#include "cli/readings/readings.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"

namespace ripplenotch {
namespace {

// At one speed nothing tells an inertia from an offset.
bool speed_changes(const Trace& trace) {
    constexpr double enough = 0.1;  // of the fastest
    double least = 0.0, greatest = 0.0;
    for (const double speed : trace.velocity_deg_s) {
        if (!std::isfinite(speed)) continue;
        least = std::min(least, speed);
        greatest = std::max(greatest, speed);
    }
    double slowest = std::max(-least, greatest);
    const double fastest = slowest;
    for (const double speed : trace.velocity_deg_s)
        if (std::isfinite(speed)) slowest = std::min(slowest, std::abs(speed));
    return fastest > 0.0 && fastest - slowest > enough * fastest;
}

}  // namespace

Model identified_model(const DiagnoseRequest& request, const LogOptions& words) {
    ReadOptions reading = words.resolve();
    reading.gear_ratio = request.gear.ratio;
    reading.takes_motor_units = true;
    std::vector<Log> logs;
    logs.push_back(read_log_in_part(request.path, reading, most_rows_held));
    IdentifyOptions options;
    std::optional<GearRatio> stated;
    if (request.gear.ratio) options.hint = stated = GearRatio(*request.gear.ratio);
    const JointFile joint{request.path, request.path, identify_readings(logs, options)};
    const JointFacts facts = joint.facts(stated);
    if (!facts.gear_ratio)
        raise<DataError>(
            "{}: --model auto: identify tells no gear ratio from it ({}); give --gear-ratio N, or --model "
            "FILE",
            request.path, joint.found.verdict);
    Model model{*facts.gear_ratio, {}};
    if (speed_changes(logs.front().trace)) model.terms.push_back(parse_term("inertia"));
    for (const Order order : facts.orders)
        model.terms.push_back(parse_term(fmt::format("ripple,order={}", shortest(order.value()))));
    return model;
}

std::string model_in_words(const Model& model) {
    std::string text = fmt::format("gear ratio {:.6g}", model.gear_ratio.value());
    std::vector<std::string> orders;
    for (const Term& term : model.terms) {
        if (term.effect->name == "ripple") {
            orders.push_back(shortest(term.values.front().value_or(0.0)));
        } else {
            text += fmt::format(", {}", term.effect->name);
        }
    }
    if (!orders.empty())
        text += fmt::format(", ripple of order{} {}", orders.size() == 1 ? "" : "s",
                            fmt::join(orders, orders.size() == 2 ? " and " : ", "));
    return text;
}

}  // namespace ripplenotch
