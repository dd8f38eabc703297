// SPDX-License-Identifier: MIT
#pragma once
// What a diagnosis says of the angle of logs without position, in its document.

#include "document/fields/fields.hpp"
#include "ripplenotch/diagnose/diagnosis.hpp"

namespace ripplenotch {

/// Sets "angle" where a log has no position.
void put_angle(Json& json, const Diagnosis& diagnosis);
void read_angle(Fields& fields, Diagnosis& diagnosis);

}  // namespace ripplenotch
