// SPDX-License-Identifier: MIT
#pragma once
// The member `simulated` of a model.json: the torque of the user's own simulation as a part of the model.

#include <optional>
#include <string>

namespace ripplenotch {

struct SimulatedTerm {
    std::string column;           ///< of the log, or of the simulation's own
    std::optional<double> scale;  ///< empty: 1, and whether it is another is one of a diagnosis' questions
    double delay_s = 0.0;         ///< by which the column is later than the log
};

}  // namespace ripplenotch
