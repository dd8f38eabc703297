// SPDX-License-Identifier: MIT
#pragma once
// The values that a model does not state, estimated from a measured torque by separable least squares.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "ripplenotch/model/effect.hpp"
#include "ripplenotch/model/fault_rules.hpp"
#include "ripplenotch/model/model.hpp"

namespace ripplenotch {

// Detection of a converter effect in a log: whether it is present, and which samples it invalidates. No model
// of the joint is needed for that.

/// A log as Effect::detect sees it. Spans have motion.size() entries.
struct LoggedTorque {
    const Motion& motion;  ///< as measured
    std::span<const double> torque_nm;
    std::span<const unsigned char> use;  ///< 0: does not count, be it for what an earlier detector found
    double moving_deg_s = 0.0;           ///< slower samples count as resting
    double step_nm = 0.0;   ///< distance of the values of a log that holds few; 0: as good as continuous
    double noise_nm = 0.0;  ///< rms, from second differences
};

struct DetectedFault {
    std::vector<double> values;  ///< values of the effect's parameters, in their order; bounds are ignored
    std::vector<std::size_t> spoiled;  ///< samples that do not hold the joint's torque, rising
    std::string words;                 ///< what was seen, for people
    double bends_nm = 0.0;  ///< steps so coarse that they bend whatever is in the torque; 0: there are none
};

/// The signal to which a noise stream belongs. Each has a stream of its own, so that adding noise to one
/// signal leaves the noise of another unchanged. The numbers are part of the definition of a seed: never
/// change one.
enum class NoiseChannel : std::uint64_t { torque = 1, velocity = 2, spikes = 3, dropout = 4 };

/// Normally distributed numbers that are the same on every machine: mt19937_64 (specified by the standard)
/// and our own transform, because std::normal_distribution differs between libraries.
class Noise {
  public:
    Noise(std::uint64_t seed, NoiseChannel channel);
    /// Mean 0, standard deviation 1 (Marsaglia's polar method).
    double normal();
    /// Uniform in [0, 1) with 53 random bits.
    double uniform();

  private:
    std::mt19937_64 engine_;
    double spare_ = 0.0;
    bool has_spare_ = false;
};

/// With `correlation` c in [0, 1) each number is c times the one before plus a fresh part (first-order
/// autoregression): 0 is white, near 1 is slow.
struct NoiseKind {
    double rms = 0.0, correlation = 0.0;
};
/// Adds noise to each value.
void add_noise(std::span<double> values, const NoiseKind& kind, std::uint64_t seed, NoiseChannel channel);

/// The same without correlation.
void add_white_noise(std::span<double> values, double rms, std::uint64_t seed, NoiseChannel channel);

/// 95 % interval, of the errors being normal and the model being linear within it. With
/// FitOptions::error_stretch they need not be white.
struct Interval {
    double low = 0.0, high = 0.0;
};

class Carriers;
class Weighing;

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
    double residual_rms_nm = 0.0;     ///< rms residual of the samples used, after whitening
    std::size_t samples = 0;          ///< used
    int iterations = 0;
    std::size_t applied = 0;  ///< number of evaluations of an effect along the motion: the cost of the fit
    bool converged = false;
};

struct FitOptions {
    /// First guesses: a model of the same terms. Values that it states take the place of Parameter::start.
    const Model* first_guess = nullptr;
    /// Coefficients a1 ... ap of the noise e(k) = a1 e(k-1) + ... + ap e(k-p) + white. Empty: white.
    std::span<const double> noise_color = {};
    /// Samples to leave out, 0 for those; torque_nm.size() entries or none. The p samples after each of them
    /// are left out as well.
    std::span<const unsigned char> use = {};
    int most_iterations = 50;  ///< chosen, not derived
    /// Improvement of the sum of squares at which the search ends, relative.
    double settled = 1e-9;
    /// Samples in a stretch of the log, for errors from the pull of the residual in each stretch: correlated
    /// noise and local model errors widen them. 0: the noise is white.
    std::size_t error_stretch = 0;
    /// Whether standard errors are computed, which takes about one more iteration.
    bool errors = true;
    /// In place of noise_color and use; it must be made for torques of the same length.
    const Weighing* weighing = nullptr;
    /// Kept for further fits along the same motion; none: the fit has its own.
    Carriers* carriers = nullptr;
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
