// SPDX-License-Identifier: MIT
#pragma once
// Values of adopted terms in the catalogue's parameters, with 95 % intervals.

#include <string>
#include <vector>

#include "diagnose/engine/criterion.hpp"
#include "ripplenotch/model/fit.hpp"

namespace ripplenotch::engine {

struct ValuedTerm {
    Term term;
    std::vector<FittedValue> values;  ///< FittedValue::term is the term's place in the set
};

/// A term of the catalogue for each term of the set. Intervals are of a jackknife over
/// stretches of the log, of all linear values and the linearised others together, with the priors.
[[nodiscard]] std::vector<ValuedTerm> valued_terms(Criterion& criterion, const SearchedTerms& terms);

/// The intervals of its sizes hold those of no effect.
[[nodiscard]] bool may_be_absent(const ValuedTerm& valued);

/// The terms with their searched values at the minimum, which the search reaches to some per cent.
[[nodiscard]] SearchedTerms polished(Criterion& criterion, const SearchedTerms& terms);

/// The factor of a column of the baseline.
struct ValuedColumn {
    std::string name;
    double factor = 0.0, standard_error = 0.0;
};
/// Of every column of the baseline, in its order.
[[nodiscard]] std::vector<ValuedColumn> valued_columns(Criterion& criterion, const SearchedTerms& terms);

}  // namespace ripplenotch::engine
