// SPDX-License-Identifier: MIT
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/portable_math.hpp"
#include "ripplenotch/core/spec.hpp"
#include "ripplenotch/model/fit.hpp"
#include "ripplenotch/model/model.hpp"
#include "ripplenotch/model/sensors.hpp"
#include "ripplenotch/model/setup_fault.hpp"

namespace ripplenotch {

namespace {

// SplitMix64's finalizer (Steele, Lea, Flood 2014): neighbouring seeds and channels become unrelated engine
// seeds.
std::uint64_t mixed(std::uint64_t seed, NoiseChannel channel) {
    std::uint64_t z = seed + 0x9e3779b97f4a7c15U * static_cast<std::uint64_t>(channel);
    z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9U;
    z = (z ^ (z >> 27U)) * 0x94d049bb133111ebU;
    return z ^ (z >> 31U);
}

}  // namespace

Noise::Noise(std::uint64_t seed, NoiseChannel channel) : engine_(mixed(seed, channel)) {}

double Noise::uniform() { return static_cast<double>(engine_() >> 11U) * 0x1p-53; }

double Noise::normal() {
    if (has_spare_) {
        has_spare_ = false;
        return spare_;
    }
    // A point uniform in the unit disc; its squared radius is uniform too, and independent of its direction.
    double x = 0.0, y = 0.0, square = 0.0;
    do {
        x = 2.0 * uniform() - 1.0;
        y = 2.0 * uniform() - 1.0;
        square = x * x + y * y;
    } while (square >= 1.0 || square == 0.0);
    const double stretch = std::sqrt(-2.0 * portable::log(square) / square);
    spare_ = y * stretch;
    has_spare_ = true;
    return x * stretch;
}

void add_noise(std::span<double> values, const NoiseKind& kind, std::uint64_t seed, NoiseChannel channel) {
    const auto [rms, correlation] = kind;
    if (rms == 0.0) return;
    Noise noise(seed, channel);
    // The first number is drawn from where the process settles, so that the rms is the same from the start.
    const double fresh = std::sqrt(1.0 - correlation * correlation);
    double state = 0.0, share = 1.0;
    for (double& value : values) {
        state = correlation * state + share * noise.normal();
        share = fresh;
        value += rms * state;
    }
}

void add_white_noise(std::span<double> values, double rms, std::uint64_t seed, NoiseChannel channel) {
    add_noise(values, {.rms = rms}, seed, channel);
}

namespace {

bool is_stated_sensor(const Term& term) {
    return side_of(term) == Side::sensor && std::all_of(term.values.begin(), term.values.end(),
                                                        [](const auto& value) { return value.has_value(); });
}

}  // namespace

bool has_sensors(const Model& model) {
    return std::any_of(model.terms.begin(), model.terms.end(), is_stated_sensor);
}

void through_sensors(const Model& model, const Motion& motion, std::vector<double>& torque_nm) {
    for (const Term& term : model.terms) {
        if (is_stated_sensor(term))
            term.effect->apply({.motion = motion, .ratio = model.gear_ratio}, values_of(term), torque_nm);
    }
}

std::string_view setup_fault_name(SetupFaultKind kind) {
    switch (kind) {
        case SetupFaultKind::wrong_joint:
            return "wrong-joint";
        case SetupFaultKind::other_motion:
            return "other-motion";
        case SetupFaultKind::motion_sign:
            return "motion-sign";
        case SetupFaultKind::motion_unit:
            return "motion-unit";
        case SetupFaultKind::motor_side_motion:
            return "motor-side-motion";
        case SetupFaultKind::torque_sign:
            return "torque-sign";
        case SetupFaultKind::torque_unit:
            return "torque-unit";
        case SetupFaultKind::motor_side_torque:
            return "motor-side-torque";
        case SetupFaultKind::gravity_direction:
            break;
    }
    return "gravity-direction";
}

namespace {

std::size_t known_parameter(const Effect& effect, const std::string& name) {
    if (const auto place = find_parameter(effect, name)) return *place;
    std::vector<std::string> known;
    for (const Parameter& parameter : effect.parameters) known.emplace_back(parameter.name);
    raise<UsageError>("effect {} has no parameter '{}'{}; its parameters: {}", effect.name, name,
                      did_you_mean(name, known), fmt::join(known, ", "));
}

}  // namespace

Term parse_term(std::string_view text) {
    const Spec spec = parse_spec(text);
    const Effect& effect = find_effect(spec.name);
    Term term{&effect, std::vector<std::optional<double>>(effect.parameters.size())};
    for (const auto& [name, value_text] : spec.values) {
        const std::size_t place = known_parameter(effect, name);
        const Parameter& parameter = effect.parameters[place];
        const std::string label = fmt::format("effect {}, {}", effect.name, name);
        const double value = parse_quantity(value_text, dimension_of(parameter), label);
        if (!allows(parameter, value)) {
            raise<UsageError>("{}: {} is not between {} and {} {}", label, value_text,
                              shortest(parameter.lower), shortest(parameter.upper), parameter.unit);
        }
        term.values[place] = value;
    }
    return term;
}

double most_in(const Model& model, const Effect& effect, std::size_t parameter) {
    const Parameter& described = effect.parameters[parameter];
    const bool is_step = effect.resists && described.name == "width_deg_s" && model.widest_step_deg_s > 0.0;
    return is_step ? std::clamp(model.widest_step_deg_s, described.start, described.upper) : described.upper;
}

double least_in(const Model& model, const Effect& effect, std::size_t parameter) {
    const Parameter& described = effect.parameters[parameter];
    const bool has_size_alone = std::ranges::all_of(
        effect.parameters, [](const Parameter& one) { return one.linear || one.name == "width_deg_s"; });
    const bool may_be_too_much =
        model.beside_simulation && effect.resists && has_size_alone && parameter == 0;
    return may_be_too_much ? -described.upper : described.lower;
}

Side side_of(const Term& term) {
    const auto& whole = term.effect->whole;
    return whole && term.values[*whole].value_or(0.0) >= 0.5 ? Side::sensor : term.effect->side;
}

std::vector<double> values_of(const Term& term) {
    std::vector<double> values;
    for (std::size_t p = 0; p < term.values.size(); ++p) {
        const Parameter& parameter = term.effect->parameters[p];
        values.push_back(parameter.left_out == LeftOut::assumed ? term.values[p].value_or(parameter.start)
                                                                : term.values[p].value());
    }
    return values;
}

GearAccount gear_of(const Model& model, std::string source) {
    std::vector<Order> orders;
    for (const Term& term : model.terms) {
        const auto place = term.effect->ripple_order;
        if (place && term.values[*place]) orders.emplace_back(*term.values[*place]);
    }
    std::sort(orders.begin(), orders.end());
    orders.erase(std::unique(orders.begin(), orders.end()), orders.end());
    return {model.gear_ratio, std::move(orders), {}, {}, std::move(source)};
}

std::vector<std::string> missing_values(const Model& model) {
    std::vector<std::string> names;
    for (std::size_t i = 0; i < model.terms.size(); ++i) {
        const Term& term = model.terms[i];
        for (std::size_t p = 0; p < term.values.size(); ++p) {
            const Parameter& parameter = term.effect->parameters[p];
            if (term.values[p] || parameter.left_out == LeftOut::assumed) continue;
            names.push_back(fmt::format("effects[{}].{} of {}", i, parameter.name, term.effect->name));
        }
    }
    return names;
}

}  // namespace ripplenotch
