// SPDX-License-Identifier: MIT
#pragma once
// Values of what is believed beside a leftover, with intervals that say how uncertain a leftover makes them.

#include <vector>

#include "core/matrices/normal_errors.hpp"
#include "diagnose/beside/weighing/sums.hpp"
#include "ripplenotch/model/fit.hpp"

namespace ripplenotch {

struct BesideValues {
    Term term;
    std::vector<FittedValue>
        values;           ///< of its sizes, phases and scales; FittedValue::term is its place here
    bool is_told = true;  ///< the interval of its size does not hold 0
    /// What rings in a ripple, whose size and phase are then those of what passes the elastic joint.
    std::optional<Term> ringing = {};
    std::vector<FittedValue> ringing_values = {};
};

/// Its torque in Nm beside the model, a value per sample; what rings in it is part of it.
[[nodiscard]] std::vector<double> torque_of(const BesideValues& values, const Model& beside,
                                            const Motion& motion);

/// Sizes from the whitened log. Their intervals are of the scores of blocks of the log, widened by
/// rules.beside.interval_factor, and reach from there to the plain least-squares size.
[[nodiscard]] std::vector<BesideValues> values_beside(Sums& sums, const std::vector<Shape>& believed);

}  // namespace ripplenotch
