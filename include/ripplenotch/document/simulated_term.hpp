// SPDX-License-Identifier: MIT
#pragma once
// The member `simulated` of a model.json: the torque of the user's own simulation as a part of the model.

#include <optional>
#include <string>

namespace ripplenotch {

struct SimulatedTerm {
    std::string column;           ///< of the log, or of the simulation's own
    std::optional<double> scale;  ///< empty: fitted
    double delay_s = 0.0;         ///< by which the column is later than the log
    bool fit_delay = false;       ///< in place of delay_s
    bool fit_friction = false;    ///< it has Coulomb friction of its own, whose error is fitted beside it
    /// What had to be fitted beside it and nobody named: an offset, and the simulation's error at the joint.
    double offset_nm = 0.0, inertia_kgm2 = 0.0, gravity_cosine_nm = 0.0, gravity_sine_nm = 0.0;
};

}  // namespace ripplenotch
