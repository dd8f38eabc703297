// SPDX-License-Identifier: MIT
#pragma once
// The parts of which a diagnosis makes its answer, in the order of the data.

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "diagnose/engine/recorded_motion.hpp"
#include "ripplenotch/core/trace.hpp"
#include "ripplenotch/diagnose/diagnosis.hpp"
#include "ripplenotch/model/fit.hpp"
#include "ripplenotch/model/model.hpp"
#include "ripplenotch/model/motion.hpp"

namespace ripplenotch {

// Faults of the converter, seen in the logged torque itself: no model of the joint is needed for them.

/// In the order of their detectors. Rows that they spoiled become 0 in `use`.
[[nodiscard]] std::vector<Fault> find_faults(const Motion& motion, std::span<const double> torque_nm,
                                             std::vector<unsigned char>& use);

// A model with its values from the whole log, and what it leaves: by the motion and the smoothing that
// `simulate` has along a log, so that both state the same residual.

/// An entry per row of the log in every vector.
struct LogAlong {
    Motion motion;  ///< with the known torque, its values as given
    std::vector<double> torque_nm;
    std::vector<unsigned char> use;  ///< 0: nothing is fitted to this row
    /// Columns of the known torque whose factor has a prior, and its standard deviation: an arm's masses.
    std::vector<std::vector<double>> uncertain_nm;
    std::vector<double> deviation;

    [[nodiscard]] std::size_t size() const { return torque_nm.size(); }
};
[[nodiscard]] LogAlong log_along(const TraceView& log, std::span<const GivenTerm> given, Seconds smoothing);

struct SettledModel {
    Model model;                      ///< every value stated
    std::vector<FittedValue> values;  ///< of those that were open
    std::vector<double> departure;    ///< of the uncertain factors from their prior means
    std::vector<double> residual_nm;  ///< measured less predicted, all rows
};

/// Fits the open values by least squares on the rows that count, with the uncertain factors as they are.
[[nodiscard]] SettledModel settled(const Model& open, const LogAlong& log, std::span<const double> departure,
                                   const Model* first_guess = nullptr);

/// The residual on another log, or of another model with all values stated.
[[nodiscard]] std::vector<double> residual_along(const Model& stated, const LogAlong& log,
                                                 std::span<const double> departure);

using engine::rms_where;

/// All values of the given terms, in their order, with 95 % intervals of those that were fitted. `errors`:
/// standard errors of the departures.
[[nodiscard]] std::vector<GivenValue> values_of_given(std::span<const GivenTerm> given,
                                                      std::span<const double> departure,
                                                      std::span<const double> errors);

// What an improved model leaves above the noise, and where.

/// Empty where the residual is noise. `noise_nm` is what no smooth law explains.
[[nodiscard]] std::optional<RemainingResidual> remaining_residual(const Motion& motion,
                                                                  std::span<const double> residual_nm,
                                                                  std::span<const unsigned char> use,
                                                                  double noise_nm);

// What a diagnosis leaves open, and what its user can do about it.

/// True when the effect's torque depends on where the joint is and not only on how it moves, which the
/// integral of a velocity does not tell. Ripple is not among them: a whole turn of the motor changes nothing.
[[nodiscard]] bool needs_position(const Effect& effect);

/// `named` and `ambiguous` from the findings.
void name_findings(Diagnosis& diagnosis);

/// From what was named and what is left.
[[nodiscard]] DiagnosisVerdict verdict_of(const Diagnosis& diagnosis);

/// A sentence each; nothing where nothing is uncertain. `motion` is the log's.
[[nodiscard]] std::vector<std::string> next_steps(const Diagnosis& diagnosis, const Motion& motion);

/// Why a name of --accept is not in the model.
[[nodiscard]] std::string why_not_accepted(const Diagnosis& diagnosis, const std::string& name);

/// Below 1 Hz, from 1 to 10 Hz, and above; an entry per row of the log in each list. A mean counts below
/// 1 Hz, but for that of the torque.
[[nodiscard]] std::vector<BandGap> band_gaps(std::span<const double> torque_nm,
                                             std::span<const double> beside_given_nm,
                                             std::span<const double> after_nm, Hertz sample_rate);

}  // namespace ripplenotch
