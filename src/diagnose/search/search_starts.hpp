// SPDX-License-Identifier: MIT
#pragma once
// Where the search for an effect may begin: the values that the catalogue says to try, and those that the
// residual itself shows.

#include <optional>
#include <vector>

#include "diagnose/case/lines.hpp"
#include "diagnose/search/change_times.hpp"
#include "diagnose/search/model_bench.hpp"

namespace ripplenotch {

/// What the whole residual shows: lines finer than a thinned log resolves.
struct Hints {
    std::vector<double> tones_hz, orders;
    GearRatio ratio;
    RatioCandidates ratios;
    std::optional<double> delay_s = {};
    ChangeTimes changes;
    double least_order =
        0.0;  ///< of what goes with position and direction: fewer cycles per turn are not passed
};

/// What the parameter has to be for the effect to make `stated` the ratio `wanted`.
[[nodiscard]] double value_for_ratio(const Effect& effect, std::size_t parameter, GearRatio stated,
                                     double wanted);

/// Gear ratios that are compared beside a model whose ratio is `about`. An order that the search chose from
/// its list states nothing: a ratio that brings it nearer to another one of the list is that order of the
/// same gear.
[[nodiscard]] RatioRange ratios_beside(const Candidate& model, double about, const DiagnosisRules& rules);

[[nodiscard]] Hints hints_of(const ModelBench& bench, const Candidate& model,
                             const std::vector<double>& left_nm);

/// The effect with every combination of the values at which its search may begin. `samples`: of the log.
/// `cells` is multiplied by the number of places that were compared to choose them.
[[nodiscard]] std::vector<Term> starts_of(const Effect& effect, const Hints& hints, double samples,
                                          double& cells);

/// A joint has one delay, one lag, one gear ratio, ripple grows with the speed in one way, and friction of
/// one form has one size: what a second one would correct is another effect's. `open`: values to be fitted
/// are empty.
[[nodiscard]] bool is_there_already(const Term& tried, const Model& open);

}  // namespace ripplenotch
