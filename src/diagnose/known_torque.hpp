// SPDX-License-Identifier: MIT
#pragma once
// The torque that is known before a diagnosis: of the user's simulation, of an arm's rigid bodies.

#include <span>
#include <vector>

#include "diagnose/case/case.hpp"
#include "diagnose/case/noise_floor.hpp"
#include "ripplenotch/diagnose/diagnosis.hpp"
#include "ripplenotch/model/given_term.hpp"

namespace ripplenotch {

/// Puts the known torque, with its values as given, into the motion of a case that has every row of the log.
/// Values that are not certain become nuisance parameters of the case, with their prior deviation. The scale
/// of a simulation does not: whether it is 1 is a question for the effect `simulation-scale`.
void take_known_torque(Case& whole, std::span<const GivenTerm> given);

/// Departures of the uncertain values from their means: generalized least squares beside this model, with the
/// noise's colour and the priors.
struct KnownValues {
    std::vector<double> departure, standard_error;  ///< one for each of Case::uncertain
};
[[nodiscard]] KnownValues fit_known_values(const Case& looked_at, const Model& stated, const NoiseFloor& noise);

/// The same case with these departures in its known torque.
[[nodiscard]] Case with_known_values(Case looked_at, const KnownValues& values);

/// All values of the given terms, in their order, with 95 % intervals of those that were fitted.
[[nodiscard]] std::vector<GivenValue> reported_values(std::span<const GivenTerm> given,
                                                      const KnownValues& values);

}  // namespace ripplenotch
