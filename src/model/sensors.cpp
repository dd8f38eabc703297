// SPDX-License-Identifier: MIT
#include "ripplenotch/model/sensors.hpp"

#include <algorithm>

namespace ripplenotch {
namespace {

bool is_stated_sensor(const Term& term) {
    return side_of(term) == Side::sensor && std::all_of(term.values.begin(), term.values.end(),
                                                        [](const auto& value) { return value.has_value(); });
}

}  // namespace

bool has_sensors(const Model& model) {
    return std::any_of(model.terms.begin(), model.terms.end(), is_stated_sensor);
}

void through_sensors(const Model& model, const Motion& motion, std::vector<double>& torque_nm) {
    for (const Term& term : model.terms) {
        if (is_stated_sensor(term))
            term.effect->apply({.motion = motion, .ratio = model.gear_ratio}, values_of(term), torque_nm);
    }
}

}  // namespace ripplenotch
