// SPDX-License-Identifier: MIT
#pragma once
// At which speed a ripple that swells has the amplitude of its term. A ripple that is nothing at rest has no
// amplitude there, and a gain on nothing is a number that no log tells: it is stated from a speed of the log.

#include "diagnose/search/model_bench.hpp"

namespace ripplenotch {

/// The speed of the log from which such a ripple is stated: the rms of those at which the joint moves, in two
/// digits. 0 where it rests.
[[nodiscard]] double usual_speed_deg_s(const Case& looked_at);

/// States each change of the ripple that was found (it has a price) from rest, or from the usual speed where
/// less of the ripple than search.least_at_rest is there at rest. Terms whose ripple is not all fitted stay
/// as they are. The torque stays the same.
void state_where_told(Candidate& model, const Case& looked_at, const DiagnosisRules& rules);

}  // namespace ripplenotch
