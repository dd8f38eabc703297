// SPDX-License-Identifier: MIT
#pragma once
// What is found beside a leftover with one account of the sensor, and how it is told.

#include <span>
#include <vector>

#include "diagnose/beside/finding/beside.hpp"
#include "diagnose/beside/finding/other_log.hpp"

namespace ripplenotch {

struct Look {
    Lens lens;
    Sums sums;
    NamedBeside named;
    std::vector<OtherLeft> other;  ///< in the order of named.findings

    Look(const GivenCase& log, const GivenCase* validation, const Candidate& model,
         std::span<const Effect* const> effects, const DiagnosisRules& rules, Work& work);
    Look(const Look&) = delete;
    Look& operator=(const Look&) = delete;
};

/// What gear and bearings carry of the given terms beside all that is believed, by plain least squares.
[[nodiscard]] std::vector<double> carried_beside(Look& look, const Candidate& model);

/// Findings with their values and places, what is believed, and the values of what is given. Beside an arm
/// the offset is a finding of its own, where the log tells it.
[[nodiscard]] BesideOutcome outcome_of(Look& look, const GivenCase& log, const Candidate& model,
                                       std::span<const Effect* const> effects);

/// True beside an arm. Beside a simulation the offset and the delay are the simulation's.
[[nodiscard]] bool is_arm_alone(std::span<const GivenTerm> given);

}  // namespace ripplenotch
