// SPDX-License-Identifier: MIT
#pragma once
// The values that a model does not state, estimated from a measured torque by separable least squares.

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "ripplenotch/core/interval.hpp"
#include "ripplenotch/model/effect.hpp"
#include "ripplenotch/model/model.hpp"

namespace ripplenotch {

struct FittedValue {
    std::size_t term = 0, parameter = 0;  ///< places in the model
    double value = 0.0;
    std::optional<double> standard_error;  ///< empty: the log does not determine this value
    std::optional<Interval> ci95;          ///< empty with it; may reach beyond the parameter's bounds
    bool at_bound = false;                 ///< the best value within the bounds is a bound
};

struct Fit {
    Model model;                      ///< with every value that can be fitted
    std::vector<FittedValue> values;  ///< in the order of terms and parameters
    double residual_rms_nm = 0.0;     ///< rms residual of the samples used
    std::size_t samples = 0;          ///< used
    int iterations = 0;
    bool converged = false;
};

struct FitOptions {
    /// First guesses: a model of the same terms. Values that it states take the place of Parameter::start.
    const Model* first_guess = nullptr;
    /// Samples to leave out, 0 for those; torque_nm.size() entries or none.
    std::span<const unsigned char> use = {};
    int max_iterations = 50;  ///< chosen, not derived
    /// Improvement of the sum of squares at which the search ends, relative.
    double settled = 1e-9;
    /// Samples in a stretch of the log, for errors from the pull of the residual in each stretch: correlated
    /// noise and local model errors widen them. 0: the noise is white.
    std::size_t error_stretch = 0;
    /// Whether standard errors are computed, which takes about one more iteration.
    bool errors = true;
};

/// Estimates the values that `model` leaves out (LeftOut::fitted) so that the sum of squares of `torque_nm`
/// less predict_nm is least. Values that the torque is linear in are solved for; the others are searched by
/// Levenberg and Marquardt's method from their first guess, within their bounds, so that the nearest minimum
/// is found and not the deepest. `torque_nm` has motion.size() entries. Values of random effects remain
/// unstated. Throws UsageError: a value has to be stated (LeftOut::refused), or there are fewer samples than
/// values.
[[nodiscard]] Fit fit(const Model& model, const Motion& motion, std::span<const double> torque_nm,
                      const FitOptions& options = {});

}  // namespace ripplenotch
