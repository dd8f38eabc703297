// SPDX-License-Identifier: MIT
#pragma once
// The torque that is known before a diagnosis: of the user's simulation, of an arm's rigid bodies.

#include <limits>
#include <span>
#include <vector>

#include "core/matrices/factorisations.hpp"
#include "diagnose/case/case.hpp"
#include "diagnose/case/noise_floor.hpp"
#include "ripplenotch/diagnose/diagnosis.hpp"
#include "ripplenotch/model/model.hpp"

namespace ripplenotch {

// Least squares in which each value is drawn towards 0 as by a measurement of its own.

/// Deviation of a value of which nothing is known.
inline constexpr double any_size = std::numeric_limits<double>::infinity();

class Ridge {
  public:
    /// `columns` must outlive it, all of one length. `deviation`: prior of each value, infinity leaves it
    /// free. `noise`: rms residual of the columns, relative to which deviations are weighted.
    Ridge(const std::vector<std::vector<double>>& columns, std::span<const double> deviation, double noise);

    [[nodiscard]] std::vector<double> solve(std::span<const double> target) const;
    /// Standard errors of the values, where the residual of the columns is white and of rms `noise`.
    [[nodiscard]] std::vector<double> standard_errors() const;

  private:
    const std::vector<std::vector<double>>& columns_;
    double noise_;
    ScaledDefiniteFactors factored_;
};

// Measured less predicted torque of a case.

/// rms of the values that `use` counts.
[[nodiscard]] double rms_of(const std::vector<double>& values, const std::vector<unsigned char>& use);

/// Measured less predicted torque, a number a sample.
[[nodiscard]] std::vector<double> residual_nm(const Case& looked_at, const Model& stated);
/// rms of it over the samples that count.
[[nodiscard]] double left_rms(const Case& looked_at, const Model& stated);

/// Puts the known torque, with its values as given, into the motion of a case that has every row of the log.
/// Values that are not certain become nuisance parameters of the case, with their prior deviation. The scale
/// of a simulation is not one of them: whether it is 1 is a question for the effect `simulation-scale`.
void take_known_torque(Case& whole, std::span<const GivenTerm> given);

/// Departures of the uncertain values from their means, and their standard errors; one for each of
/// Case::uncertain.
struct KnownValues {
    std::vector<double> departure, standard_error;
};

/// The fit of the uncertain values to the residual of a model: generalized least squares with the noise's
/// colour and the priors.
class KnownFit {
  public:
    /// The columns are taken through the sensors of `model`. `weighing`: of the case.
    KnownFit(const Case& looked_at, const Model& model, const Weighing& weighing, double white_nm);
    KnownFit(const KnownFit&) = delete;
    KnownFit& operator=(const KnownFit&) = delete;

    [[nodiscard]] KnownValues values(const Weighing& weighing, const std::vector<double>& left_nm) const;
    /// The residual after the uncertain values are fitted to it.
    [[nodiscard]] std::vector<double> residual(const Weighing& weighing, std::vector<double> left_nm) const;

  private:
    std::vector<std::vector<double>> sensed_nm_, white_;
    Ridge fit_;
};

/// The same for a case and this model.
[[nodiscard]] KnownValues fit_known_values(const Case& looked_at, const Model& stated,
                                           const NoiseFloor& noise);

/// The same case with these departures in its known torque.
[[nodiscard]] Case with_known_values(Case looked_at, const KnownValues& values);

/// All values of the given terms, in their order, with 95 % intervals of those that were fitted.
[[nodiscard]] std::vector<GivenValue> reported_values(std::span<const GivenTerm> given,
                                                      const KnownValues& values);

}  // namespace ripplenotch
