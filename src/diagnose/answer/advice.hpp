// SPDX-License-Identifier: MIT
#pragma once
// What a diagnosis leaves open, and what its user can do about it.

#include <string>
#include <vector>

#include "ripplenotch/diagnose/diagnosis.hpp"
#include "ripplenotch/model/motion.hpp"

namespace ripplenotch {

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
