// SPDX-License-Identifier: MIT
#pragma once
// Values of adopted terms in the catalogue's parameters, with 95 % intervals.

#include <vector>

#include "diagnose/engine/criterion.hpp"
#include "ripplenotch/model/fit.hpp"

namespace ripplenotch::engine {

struct ValuedTerm {
    Term term;
    std::vector<FittedValue> values;  ///< FittedValue::term is the term's place in the set
};

/// A term of the catalogue for each term of the set. Intervals are of the sandwich covariance over blocks, of
/// all linear values and the linearised others together, with the priors.
[[nodiscard]] std::vector<ValuedTerm> valued_terms(Criterion& criterion, const SearchedTerms& terms);

}  // namespace ripplenotch::engine
