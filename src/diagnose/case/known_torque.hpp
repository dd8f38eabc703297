// SPDX-License-Identifier: MIT
#pragma once
// The torque that is known before a diagnosis: of the user's simulation, of an arm's rigid bodies.

#include <span>
#include <vector>

#include "diagnose/case/case.hpp"
#include "diagnose/case/noise_floor.hpp"
#include "diagnose/case/ridge.hpp"
#include "ripplenotch/diagnose/diagnosis.hpp"
#include "ripplenotch/model/model.hpp"

namespace ripplenotch {

/// Puts the known torque, with its values as given, into the motion of a case that has every row of the log.
/// Values that are not certain become nuisance parameters of the case, with their prior deviation. The scale
/// of a simulation does not: whether it is 1 is a question for the effect `simulation-scale`.
void take_known_torque(Case& whole, std::span<const GivenTerm> given);

/// Departures of the uncertain values from their means, and their standard errors; one for each of
/// Case::uncertain.
struct KnownValues {
    std::vector<double> departure, standard_error;
};

/// The fit of the uncertain values to what a model leaves: generalized least squares with the noise's colour
/// and the priors.
class KnownFit {
  public:
    /// The columns are taken through the sensors of `model`. `weighing`: of the case.
    KnownFit(const Case& looked_at, const Model& model, const Weighing& weighing, double white_nm);
    KnownFit(const KnownFit&) = delete;
    KnownFit& operator=(const KnownFit&) = delete;

    [[nodiscard]] KnownValues values(const Weighing& weighing, const std::vector<double>& left_nm) const;
    /// What is left of a residual when they have their best values.
    [[nodiscard]] std::vector<double> residual(const Weighing& weighing, std::vector<double> left_nm) const;

  private:
    std::vector<std::vector<double>> sensed_nm_, white_;
    Ridge fit_;
};

/// The same along a case, beside this model.
[[nodiscard]] KnownValues fit_known_values(const Case& looked_at, const Model& stated,
                                           const NoiseFloor& noise);

/// The same case with these departures in its known torque.
[[nodiscard]] Case with_known_values(Case looked_at, const KnownValues& values);

/// All values of the given terms, in their order, with 95 % intervals of those that were fitted.
[[nodiscard]] std::vector<GivenValue> reported_values(std::span<const GivenTerm> given,
                                                      const KnownValues& values);

}  // namespace ripplenotch
