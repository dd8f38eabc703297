// SPDX-License-Identifier: MIT
#pragma once
// The known torque of a diagnosis in its document, and what its noise holds.

#include "document/fields/fields.hpp"
#include "ripplenotch/diagnose/diagnosis.hpp"

namespace ripplenotch {

/// Sets "simulated" and "residual_in_noise" where the diagnosis has them.
void put_beside(Json& json, const Diagnosis& diagnosis);
void read_beside(Fields& fields, Diagnosis& diagnosis);

}  // namespace ripplenotch
