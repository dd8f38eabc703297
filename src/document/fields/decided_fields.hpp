// SPDX-License-Identifier: MIT
#pragma once
// What a diagnosis leaves to its user: findings that were accepted, what to do next, and where the gap is.

#include "document/fields/fields.hpp"
#include "ripplenotch/diagnose/diagnosis.hpp"

namespace ripplenotch {

void put_decided(Json& json, const Diagnosis& diagnosis);
void read_decided(Fields& fields, Diagnosis& diagnosis);

}  // namespace ripplenotch
