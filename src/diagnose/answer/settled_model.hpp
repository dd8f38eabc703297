// SPDX-License-Identifier: MIT
#pragma once
// A model with its values from the whole log, and what it leaves: by the motion and the smoothing that
// `simulate` has along a log, so that both state the same residual.

#include <span>
#include <vector>

#include "ripplenotch/core/trace.hpp"
#include "ripplenotch/diagnose/diagnosis.hpp"
#include "ripplenotch/model/fit.hpp"
#include "ripplenotch/model/model.hpp"

namespace ripplenotch {

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

/// Over the rows that `use` counts.
[[nodiscard]] double rms_where(std::span<const double> values, std::span<const unsigned char> use);

/// All values of the given terms, in their order, with 95 % intervals of those that were fitted. `errors`:
/// standard errors of the departures.
[[nodiscard]] std::vector<GivenValue> values_of_given(std::span<const GivenTerm> given,
                                                      std::span<const double> departure,
                                                      std::span<const double> errors);

}  // namespace ripplenotch
