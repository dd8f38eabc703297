// SPDX-License-Identifier: MIT
// A model along a motion: motion effects first, then ripple gains, then the sum of torques, then the chain of
// sensor and converter. docs/decisions/0005-sides.md says why in this order.

#include <optional>

#include "model/term_torque.hpp"
#include "ripplenotch/model/model.hpp"

namespace ripplenotch {
namespace {

std::vector<double> evaluate(const Model& model, const Motion& logged, std::span<const double> noise_nm,
                             Chance chance) {
    refuse_missing_values(model);
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
