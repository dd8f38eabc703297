// SPDX-License-Identifier: MIT
#include "cli/filter_gear.hpp"

#include <complex>
#include <map>

#include "cli/joint_facts.hpp"

namespace ripplenotch {
namespace {

using Amplitudes = std::map<double, double>;  // by order

void remember(Amplitudes& known, const std::vector<Order>& orders, const std::vector<double>& amplitude_nm) {
    for (std::size_t i = 0; i < amplitude_nm.size() && i < orders.size(); ++i)
        known[orders[i].value()] = amplitude_nm[i];
}

}  // namespace

Gear gear_of(const std::optional<std::string>& joint_file, std::optional<double> gear_ratio,
             const std::vector<double>& orders, const ChosenMethod& method) {
    Gear gear;
    Amplitudes known;
    if (method.table != nullptr) {
        const TableSpec& spec = method.table->spec();
        gear.ratio = spec.gear_ratio;
        gear.orders = spec.orders;
        remember(known, spec.orders, spec.amplitude_nm);
    }
    if (joint_file) {
        const JointFacts joint = load_joint_facts(*joint_file);
        if (joint.gear_ratio) gear.ratio = joint.gear_ratio;
        if (!joint.orders.empty()) gear.orders = joint.orders;
        remember(known, joint.orders, joint.amplitude_nm);
    }
    const Settings& settings = *method.settings;
    if (settings.has("gear-ratio")) {
        gear.ratio = GearRatio(settings.number("gear-ratio"));
        gear.orders.clear();
        for (const double order : settings.list("orders")) gear.orders.emplace_back(order);
    }
    if (gear_ratio) gear.ratio = GearRatio(*gear_ratio);
    if (!orders.empty()) gear.orders.clear();
    for (const double order : orders) gear.orders.emplace_back(order);
    if (gear.ratio && gear.orders.empty()) gear.orders = {Order(1.0), Order(2.0)};
    for (const Order order : gear.orders) {
        const auto found = known.find(order.value());
        if (found == known.end()) {
            gear.amplitude_nm.clear();
            break;
        }
        gear.amplitude_nm.push_back(found->second);
    }
    return gear;
}

LineGains gains_of(const ChosenMethod& method, const Gear& gear, Hertz sample_rate) {
    return [contender = method.contender(), gear, sample_rate](double speed,
                                                               std::span<std::complex<double>> gains) {
        const auto frozen = contender.frozen(sample_rate, DegPerSec(speed));
        for (std::size_t i = 0; i < gains.size(); ++i) {
            const Hertz at = ripple_frequency(gear.orders[i], *gear.ratio, DegPerSec(speed));
            gains[i] = frozen ? response(frozen->cascade, at, sample_rate) : 1.0;
        }
    };
}

bool predictable(const ChosenMethod& method) {
    // The oscillator's filter at a speed is the solution of a Riccati equation: too dear for every window of
    // a log.
    return method.method->learner == nullptr && method.method->frozen != nullptr &&
           method.method->name != "oscillator";
}

}  // namespace ripplenotch
