// SPDX-License-Identifier: MIT
#pragma once
// What a diagnosis left open, as terms to be told from rivals.

#include <vector>

#include "diagnose/plan/separation.hpp"
#include "ripplenotch/diagnose/diagnosis.hpp"

namespace ripplenotch {

/// Sides of ties and findings in doubt first, then findings that have to be found again. None where nothing
/// is open. `along`: the motion of the log; `variance_nm2`: of the noise, for as many rows as `along` has.
[[nodiscard]] std::vector<AskedTerm> asked_terms(const Diagnosis& diagnosis, const Motion& along,
                                                 double variance_nm2, double enough);

}  // namespace ripplenotch
