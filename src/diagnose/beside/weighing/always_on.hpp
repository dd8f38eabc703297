// SPDX-License-Identifier: MIT
#pragma once
// What is in the torque whatever is named: given terms, the model's own effects, errors of the motion and an
// offset. Its values are fitted beside every name, and nobody's finding.

#include <span>
#include <string>
#include <vector>

#include "diagnose/search/model_bench.hpp"
#include "ripplenotch/model/given_term.hpp"

namespace ripplenotch {

/// Columns over the samples of a case, one a value, and what their values are drawn to.
struct AlwaysOn {
    std::vector<std::vector<double>> torque_nm;        ///< as the sensor tells it
    std::vector<std::vector<double>> before_delay_nm;  ///< of the stated ones; none without a delay or a lag
    std::vector<double> mean, deviation;
    std::vector<bool> bears_load;  ///< of the stated ones
    std::size_t given = 0;  ///< the first so many are the given terms', in their order; then what mends them

    std::size_t stated = 0;    ///< of the given terms and of what mends them
    std::size_t of_model = 0;  ///< the same with the model's own; the rest are errors of the motion

    /// A stated one at the joint, before the sensor's delays and lags.
    [[nodiscard]] const std::vector<double>& at_joint_nm(std::size_t column) const {
        return before_delay_nm.empty() ? torque_nm[column] : before_delay_nm[column];
    }
};

/// Given terms alone, for the samples of this case; `given` has a row per row of the whole log. What mends a
/// simulation at the joint itself is added when there is a given term that is no arm: inertia, gravity, and
/// an offset with any.
[[nodiscard]] AlwaysOn given_columns(const Case& looked_at, const Model& model,
                                     std::span<const GivenTerm> given, const DiagnosisRules& rules);
/// Names of the values in given_columns(), "simulated", "mended inertia_kgm2", ...
[[nodiscard]] std::vector<std::string> given_names(const Model& model, std::span<const GivenTerm> given);

/// given_columns(), and how the torque changes with the values of the model's own effects that are open, and
/// errors of the motion. Without a given term there is an offset all the same.
[[nodiscard]] AlwaysOn always_on(const Case& looked_at, const Candidate& model,
                                 std::span<const GivenTerm> given, const DiagnosisRules& rules);

/// What the given terms bring with these values: the sum of columns times values over the case.
[[nodiscard]] std::vector<double> brought_nm(const AlwaysOn& columns, std::span<const double> values,
                                             std::size_t first, std::size_t end);

/// The part of the stated ones that gear and bearings carry.
[[nodiscard]] std::vector<double> carried_nm(const AlwaysOn& columns, std::span<const double> values);

}  // namespace ripplenotch
