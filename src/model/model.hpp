// SPDX-License-Identifier: MIT
#pragma once
// The contributions of the terms of a model along a motion, before they are summed: shared by a whole
// evaluation and by Prediction, which needs parts of one.

#include <complex>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "ripplenotch/model/model.hpp"

namespace ripplenotch {

using Gain = std::vector<std::complex<double>>;

template <class Action>
void each(const Model& model, Side side, const Action& action) {
    for (const Term& term : model.terms) {
        if (side_of(term) == side) action(*term.effect, values_of(term));
    }
}

/// Whether the torques behind this term see another motion than the log's.
[[nodiscard]] inline bool changes_motion(const Term& term) {
    return term.effect->change_motion != nullptr && side_of(term) != Side::ripple;
}

/// The motion that the joint's torques see, and the gear ratio; empty where it is the log's.
[[nodiscard]] std::optional<Motion> motion_behind(const Model& model, const Motion& logged, GearRatio& ratio);

/// Throws UsageError that lists the values which the model does not state.
void refuse_missing_values(const Model& model);

/// Torque of the terms that bear load; nothing when no effect needs it.
[[nodiscard]] std::vector<double> load_nm(const Model& model, const Situation& situation);

/// The gain of a ripple term of the given order; empty when nothing changes the model's ripple.
[[nodiscard]] Gain gain_of(const Model& model, const Situation& situation, double order);

/// The gain of this term; empty when it is no ripple.
[[nodiscard]] Gain gain_for(const Model& model, const Term& term, const Situation& situation);

/// Adds the torque of one joint effect.
void add_torque(const Term& term, const Situation& situation, const Gain& gain, std::span<double> torque_nm);

}  // namespace ripplenotch
