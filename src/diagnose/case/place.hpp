// SPDX-License-Identifier: MIT
#pragma once
// Where in a log a torque acts.

#include <vector>

#include "diagnose/case/case.hpp"
#include "ripplenotch/diagnose/diagnosis.hpp"

namespace ripplenotch {

using PlaceRules = DiagnosisRules::PlaceRules;

/// Where `torque_nm`, which `term` adds along the case's motion, has at least half of its largest rms;
/// frequency and order are the term's own.
[[nodiscard]] Place place_of(const Case& looked_at, const std::vector<double>& torque_nm, const Term& term,
                             const PlaceRules& rules);

}  // namespace ripplenotch
