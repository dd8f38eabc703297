// SPDX-License-Identifier: MIT
#pragma once
// Names beside a leftover that nothing explains: what is found, what of it another log confirms, and the
// values.

#include <optional>
#include <span>
#include <vector>

#include "diagnose/search/model_bench.hpp"
#include "ripplenotch/diagnose/diagnosis.hpp"
#include "ripplenotch/model/given_term.hpp"

namespace ripplenotch {

/// A log and what is stated of it; `given` has a row per row of the whole log.
struct GivenCase {
    const Case& looked_at;
    std::span<const GivenTerm> given = {};
};

struct BesideOutcome {
    /// A delay or lag of the sensor, which acts on all that is given and named; the model has it besides.
    std::optional<Finding> sensor;
    std::vector<Finding> findings;  ///< in the order of adoption; those withdrawn come last
    std::vector<Term> believed;     ///< terms of the findings that are neither tentative nor not reproduced
    /// Of given_columns(), by plain least squares beside what is believed.
    std::vector<double> given_values;
    std::vector<double> given_errors;  ///< of their standard errors, from the whitened log
};

/// `model`: what is always on, fitted. `validation`: another log that nothing is fitted to, or nothing.
[[nodiscard]] BesideOutcome find_beside(const GivenCase& log, const GivenCase* validation,
                                        const Candidate& model, std::span<const Effect* const> effects,
                                        const DiagnosisRules& rules, Work& work);

}  // namespace ripplenotch
