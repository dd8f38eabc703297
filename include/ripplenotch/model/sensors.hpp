// SPDX-License-Identifier: MIT
#pragma once
// What the sensor does to a torque that is not the model's own: an arm's, a simulation's.

#include <vector>

#include "ripplenotch/model/model.hpp"

namespace ripplenotch {

/// True when the model states a delay or a lag.
[[nodiscard]] bool has_sensors(const Model& model);

/// Takes a torque at the joint in newton-metres, an entry per sample of the motion, through the delays and
/// lags that the model states, as predict_nm takes the sum of its own terms. A value that is left out acts on
/// nothing.
void through_sensors(const Model& model, const Motion& motion, std::vector<double>& torque_nm);

}  // namespace ripplenotch
