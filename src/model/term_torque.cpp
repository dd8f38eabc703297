// SPDX-License-Identifier: MIT
#include "model/term_torque.hpp"

#include <fmt/ranges.h>

#include <algorithm>

#include "ripplenotch/core/error.hpp"

namespace ripplenotch {
namespace {

bool has_side(const Model& model, Side side) {
    return std::ranges::any_of(model.terms, [&](const Term& term) { return side_of(term) == side; });
}

}  // namespace

std::optional<Motion> motion_behind(const Model& model, const Motion& logged, GearRatio& ratio) {
    std::optional<Motion> changed;
    for (const Term& term : model.terms) {
        if (!changes_motion(term)) continue;
        if (!changed) changed = logged;
        term.effect->change_motion(values_of(term), *changed, ratio);
    }
    return changed;
}

void refuse_missing_values(const Model& model) {
    if (const auto missing = missing_values(model); !missing.empty()) {
        raise<UsageError>("the model does not state {}; give the value, or fit it to a log first",
                          fmt::join(missing, ", "));
    }
}

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

Gain gain_of(const Model& model, const Situation& situation, double order) {
    if (!has_side(model, Side::ripple)) return {};
    Gain gain(situation.motion.size(), 1.0);
    each(model, Side::ripple, [&](const Effect& change, const std::vector<double>& numbers) {
        change.change_ripple(situation, Order(order), numbers, gain);
    });
    return gain;
}

void add_torque(const Term& term, const Situation& situation, const Gain& gain, std::span<double> torque_nm) {
    Situation with_gain = situation;
    with_gain.ripple_gain = gain;
    term.effect->apply(with_gain, values_of(term), torque_nm);
}

Gain gain_for(const Model& model, const Term& term, const Situation& situation) {
    if (!term.effect->ripple_order) return {};
    return gain_of(model, situation, values_of(term)[*term.effect->ripple_order]);
}

void add_joint_torque(const Model& model, const Situation& situation, std::span<double> torque_nm) {
    for (const Term& term : model.terms) {
        if (term.effect->side == Side::joint)
            add_torque(term, situation, gain_for(model, term, situation), torque_nm);
    }
}

}  // namespace ripplenotch
