// SPDX-License-Identifier: MIT
#pragma once
#include <vector>

#include "ripplenotch/model/effect.hpp"

namespace ripplenotch {

struct Term {
    const Effect* effect = nullptr;
    std::vector<double> values;      ///< one per parameter of the effect
};

/// A sum of joint effects followed by a chain of sensor effects in the order given.
struct Model {
    GearRatio gear_ratio;
    std::vector<Term> terms;
};

/// Torque along the motion, in newton-metres, without noise.
[[nodiscard]] std::vector<double> predict_nm(const Model& model, const Motion& motion);

}  // namespace ripplenotch
