// SPDX-License-Identifier: MIT
#pragma once
// Values of what is believed beside a leftover, with intervals that say how uncertain a leftover makes them.

#include <vector>

#include "core/normal_errors.hpp"
#include "diagnose/beside/sums.hpp"
#include "ripplenotch/model/fit.hpp"

namespace ripplenotch {

struct BesideValues {
    Term term;
    std::vector<FittedValue>
        values;  ///< of its sizes, phases and scales; FittedValue::term is its place here
};

/// Sizes from the whitened log. Their intervals are of the scores of blocks of the log, widened by
/// rules.beside.interval_factor, and reach from there to the plain least-squares size. Ripple is told by one
/// size and phase, however it swells.
[[nodiscard]] std::vector<BesideValues> values_beside(Sums& sums, const std::vector<Shape>& believed);

}  // namespace ripplenotch
