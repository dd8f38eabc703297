// SPDX-License-Identifier: MIT
#pragma once
// What a diagnosis says beside a leftover and of a given term, in its document.

#include "document/fields/fields.hpp"
#include "ripplenotch/diagnose/diagnosis.hpp"

namespace ripplenotch {

/// Adds to "evidence" what a finding beside a leftover rests on; nothing for another.
void put_out_of_fold(Json& evidence, const Finding& finding);
void read_out_of_fold(Fields& evidence, Finding& finding);

/// Sets "simulated" and "leftover" where the diagnosis has them.
void put_beside(Json& json, const Diagnosis& diagnosis);
void read_beside(Fields& fields, Diagnosis& diagnosis);

}  // namespace ripplenotch
