// SPDX-License-Identifier: MIT
// How often a name is wrong, as counted over simulated logs whose truth is known
// (docs/studies/diagnose-catalogue.md).

#include <algorithm>

#include "ripplenotch/diagnose/diagnosis.hpp"

namespace ripplenotch {
namespace {

// Names told in two runs of the studies (single, rarer, pair, triple, noise, poor, disturbed logs and
// formulas that are not the catalogue's): numbers from 9000 on and from 44000 on. A third run was held
// against it.
struct Counted {
    double names, wrong;
};
constexpr Counted where_explained{676.0, 1.0}, where_something_is_left{186.0, 2.0};

// The mean of what the true share may be after so many (Jeffreys), so that none wrong is not never.
double percent(const Counted& counted) { return 100.0 * (counted.wrong + 0.5) / (counted.names + 1.0); }

}  // namespace

std::optional<double> wrong_percent(const Diagnosis& diagnosis) {
    if (diagnosis.named.empty() || !diagnosis.given.empty() || diagnosis.residual_in_noise)
        return std::nullopt;
    return percent(diagnosis.verdict == DiagnosisVerdict::explained ? where_explained
                                                                    : where_something_is_left);
}

}  // namespace ripplenotch
