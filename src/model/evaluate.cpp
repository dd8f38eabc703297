// SPDX-License-Identifier: MIT
// A model along a motion: motion effects first, then ripple gains, then the sum of torques, then the chain of
// sensor and converter. docs/decisions/0005-sides.md says why in this order.

#include <fmt/ranges.h>

#include "ripplenotch/core/error.hpp"
#include "ripplenotch/model/model.hpp"

namespace ripplenotch {
namespace {

using Gain = std::vector<std::complex<double>>;

template <class Action>
void each(const Model& model, Side side, const Action& action) {
    for (const Term& term : model.terms) {
        if (term.effect->side == side) action(*term.effect, values_of(term));
    }
}

bool has(const Model& model, bool (*property)(const Effect&)) {
    for (const Term& term : model.terms) {
        if (property(*term.effect)) return true;
    }
    return false;
}

// Torque of what bears load; nothing when no effect asks for it.
std::vector<double> load_nm(const Model& model, const Situation& situation) {
    std::vector<double> load;
    if (!has(model, [](const Effect& effect) { return effect.uses_load; })) return load;
    load.resize(situation.motion.size());
    each(model, Side::joint, [&](const Effect& effect, const std::vector<double>& values) {
        if (effect.bears_load) effect.apply(situation, values, load);
    });
    return load;
}

void add_joint_torque(const Model& model, const Situation& situation, std::span<double> torque_nm) {
    const bool ripple_changes = has(model, [](const Effect& effect) { return effect.side == Side::ripple; });
    each(model, Side::joint, [&](const Effect& effect, const std::vector<double>& values) {
        if (!effect.ripple_order || !ripple_changes) return effect.apply(situation, values, torque_nm);
        Gain gain(situation.motion.size(), 1.0);
        const Order order(values[*effect.ripple_order]);
        each(model, Side::ripple, [&](const Effect& change, const std::vector<double>& numbers) {
            change.change_ripple(situation, order, numbers, gain);
        });
        Situation with_gain = situation;
        with_gain.ripple_gain = gain;
        effect.apply(with_gain, values, torque_nm);
    });
}

std::vector<double> evaluate(const Model& model, const Motion& logged, std::span<const double> noise_nm,
                             Chance chance) {
    if (const auto missing = missing_values(model); !missing.empty()) {
        raise<UsageError>("the model does not state {}; give the value, or fit it to a log first",
                          fmt::join(missing, ", "));
    }
    GearRatio ratio = model.gear_ratio;
    std::optional<Motion> changed;
    each(model, Side::motion, [&](const Effect& effect, const std::vector<double>& values) {
        if (!changed) changed = logged;
        effect.change_motion(values, *changed, ratio);
    });
    const Motion& motion = changed ? *changed : logged;
    const auto load = load_nm(model, {.motion = motion, .ratio = ratio});
    const Situation situation{.motion = motion, .ratio = ratio, .load_nm = load};
    std::vector<double> torque_nm(motion.size(), 0.0);
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

std::vector<double> measure_nm(const Model& model, const Motion& motion, std::span<const double> noise_nm,
                               Chance chance) {
    return evaluate(model, motion, noise_nm, chance);
}

}  // namespace ripplenotch
