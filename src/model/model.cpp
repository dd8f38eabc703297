// SPDX-License-Identifier: MIT
#include "ripplenotch/model/model.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/spec.hpp"

namespace ripplenotch {

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

double max_in(const Model& model, const Effect& effect, std::size_t parameter) {
    const Parameter& described = effect.parameters[parameter];
    const bool is_step = effect.resists && described.name == "width_deg_s" && model.widest_step_deg_s > 0.0;
    return is_step ? std::clamp(model.widest_step_deg_s, described.start, described.upper) : described.upper;
}

double min_in(const Model& model, const Effect& effect, std::size_t parameter) {
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

namespace {

using Gain = std::vector<std::complex<double>>;

template <class Action>
void each(const Model& model, Side side, const Action& action) {
    for (const Term& term : model.terms) {
        if (side_of(term) == side) action(*term.effect, values_of(term));
    }
}

// Whether the torques behind this term see another motion than the log's.
bool changes_motion(const Term& term) {
    return term.effect->change_motion != nullptr && side_of(term) != Side::ripple;
}

// The motion that the joint's torques see, and the gear ratio; empty where it is the log's.
std::optional<Motion> motion_behind(const Model& model, const Motion& logged, GearRatio& ratio) {
    std::optional<Motion> changed;
    for (const Term& term : model.terms) {
        if (!changes_motion(term)) continue;
        if (!changed) changed = logged;
        term.effect->change_motion(values_of(term), *changed, ratio);
    }
    return changed;
}

// Throws UsageError that lists the values which the model does not state.
void refuse_missing_values(const Model& model) {
    if (const auto missing = missing_values(model); !missing.empty()) {
        raise<UsageError>("the model does not state {}; give the value, or fit it to a log first",
                          fmt::join(missing, ", "));
    }
}

// Throws UsageError for a term that depends on a joint whose motion is not known.
void refuse_unknown_joints(const Model& model, const Motion& motion) {
    for (const Term& term : model.terms) {
        if (!term.effect->other_joint) continue;
        const auto joint = static_cast<std::size_t>(*term.values[*term.effect->other_joint]);
        if (joint <= motion.others_deg_s.size() && !motion.others_deg_s[joint - 1].empty()) continue;
        raise<UsageError>(
            "{} needs the motion of joint {} of the arm: a log of all joints, and the arm in the model or as "
            "--arm",
            term.effect->name, joint);
    }
}

// Torque of the terms that bear load; nothing when no effect needs it.
std::vector<double> load_nm(const Model& model, const Situation& situation) {
    std::vector<double> load;
    if (std::ranges::none_of(model.terms, [](const Term& term) { return term.effect->uses_load; }))
        return load;
    load = situation.motion.known_nm;
    load.resize(situation.motion.size());
    each(model, Side::joint, [&](const Effect& effect, const std::vector<double>& values) {
        if (effect.bears_load) effect.apply(situation, values, load);
    });
    return load;
}

// The gain of a ripple term of the given order; empty when nothing changes the model's ripple.
Gain gain_of(const Model& model, const Situation& situation, double order) {
    if (std::ranges::none_of(model.terms, [](const Term& term) { return side_of(term) == Side::ripple; }))
        return {};
    Gain gain(situation.motion.size(), 1.0);
    each(model, Side::ripple, [&](const Effect& change, const std::vector<double>& numbers) {
        change.change_ripple(situation, Order(order), numbers, gain);
    });
    return gain;
}

void add_joint_torque(const Model& model, const Situation& situation, std::span<double> torque_nm) {
    each(model, Side::joint, [&](const Effect& effect, const std::vector<double>& values) {
        Gain gain;
        if (effect.ripple_order) gain = gain_of(model, situation, values[*effect.ripple_order]);
        Situation with_gain = situation;
        with_gain.ripple_gain = gain;
        effect.apply(with_gain, values, torque_nm);
    });
}

// A model along a motion: motion effects first, then ripple gains, then the sum of torques, then the chain of
// sensor and converter. docs/decisions/0005-sides.md gives the reasons for this order.

std::vector<double> evaluate(const Model& model, const Motion& logged, std::span<const double> noise_nm,
                             Chance chance) {
    refuse_missing_values(model);
    refuse_unknown_joints(model, logged);
    GearRatio ratio = model.gear_ratio;
    const std::optional<Motion> changed = motion_behind(model, logged, ratio);
    const Motion& motion = changed ? *changed : logged;
    const auto load = load_nm(model, {.motion = motion, .ratio = ratio});
    const Situation situation{.motion = motion, .ratio = ratio, .load_nm = load};
    std::vector<double> torque_nm = motion.known_nm;
    torque_nm.resize(motion.size());
    add_joint_torque(model, situation, torque_nm);
    const auto transform = [&](const Effect& effect, const std::vector<double>& values) {
        if (chance == Chance::acts || !effect.chance) effect.apply(situation, values, torque_nm);
    };
    each(model, Side::sensor, transform);
    for (std::size_t k = 0; k < noise_nm.size(); ++k) torque_nm[k] += noise_nm[k];
    each(model, Side::converter, transform);
    return torque_nm;
}

}  // namespace

std::vector<double> predict_nm(const Model& model, const Motion& motion) {
    return evaluate(model, motion, {}, Chance::left_out);
}

std::vector<double> sensed_nm(const Model& model, const Motion& motion, std::vector<double> torque_nm) {
    each(model, Side::sensor, [&](const Effect& effect, const std::vector<double>& values) {
        if (effect.linear_in_torque && !effect.uses_load)
            effect.apply({.motion = motion, .ratio = model.gear_ratio}, values, torque_nm);
    });
    return torque_nm;
}

std::vector<double> measure_nm(const Model& model, const Motion& motion, std::span<const double> noise_nm,
                               Chance chance) {
    return evaluate(model, motion, noise_nm, chance);
}

}  // namespace ripplenotch
