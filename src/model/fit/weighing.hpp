// SPDX-License-Identifier: MIT
#pragma once
// How a torque along a motion becomes the numbers whose sum of squares is least in a fit: samples that do not
// count are left out, coloured noise is whitened, and nuisance terms are projected out.

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "ripplenotch/model/fit.hpp"

namespace ripplenotch {

// The coordinates in which a fit moves: a value, its logarithm, or one of the two Cartesian parts of a size
// and a phase.

enum class CoordinateKind { plain, logarithm, cosine_part, sine_part };

struct Coordinate {
    CoordinateKind kind;
    std::size_t term, parameter;  ///< for a size and phase pair, the size
    std::size_t phase;            ///< for a size and phase pair, the phase
    double start, lower, upper, step;
    bool linear;  ///< the torque is linear in all such coordinates together
};

class Coordinates {
  public:
    /// Throws UsageError when a value is missing that no fit searches for.
    Coordinates(const Model& model, const Model* first_guess);

    [[nodiscard]] const std::vector<Coordinate>& list() const { return list_; }
    /// The model with the values of a point put in.
    [[nodiscard]] Model at(const std::vector<double>& point) const;
    /// Values with their errors. `covariance` is row by row; a negative variance means "not identifiable".
    [[nodiscard]] std::vector<FittedValue> values(const std::vector<double>& point,
                                                  const std::vector<double>& covariance) const;

  private:
    void add_term(std::size_t term);
    [[nodiscard]] double guess(std::size_t term, std::size_t parameter) const;
    Model model_;
    const Model* first_guess_;
    bool sum_is_linear_ = true;
    std::vector<Coordinate> list_;
};

class Prediction;

/// How the prediction changes with a coordinate, per unit of it: exact for linear ones, by central
/// differences for the others. `prediction` is that of coordinates.at(point).
[[nodiscard]] std::vector<double> slope_nm(const Prediction& prediction, const Coordinates& coordinates,
                                           const std::vector<double>& point, std::size_t c);

/// A shape that may be in the torque besides the model, of a size that is of no interest.
struct Nuisance {
    std::vector<double> torque_nm;
    double usual_size = 0.0;  ///< rms of the factor to be expected; 0 is any
};

class Weighing {
  public:
    /// `use`: 0 for samples that do not count; empty is all. `color`: coefficients a1 ... ap of the noise
    /// e(k) = a1 e(k-1) + ... + ap e(k-p) + white; the first p samples do not count. `valid`: 0 for samples
    /// that hold no torque, `use` where it is empty. The whitening filter receives a straight line in their
    /// place, in every torque alike, so that linearity in the torques is kept.
    Weighing(std::size_t samples, std::span<const unsigned char> use, std::span<const double> color,
             std::span<const unsigned char> valid = {});

    /// `noise_nm`: rms of the white part, against which usual sizes are weighed.
    void set_nuisance(const std::vector<Nuisance>& nuisance, double noise_nm);

    [[nodiscard]] const std::vector<std::size_t>& rows() const { return rows_; }  ///< samples that count
    /// Numbers per torque: one a row, and one a nuisance whose size is bounded.
    [[nodiscard]] std::size_t size() const { return rows_.size() + bounded_; }
    /// How many of those numbers nuisances use up: directions in which nothing is left to fit.
    [[nodiscard]] std::size_t used_up() const { return basis_.size() / (size() > 0 ? size() : 1); }
    [[nodiscard]] std::vector<double> operator()(std::span<const double> torque_nm) const;
    /// The same into size() numbers from `weighed` on.
    void weigh(std::span<const double> torque_nm, double* weighed) const;
    /// Whitened only.
    [[nodiscard]] std::vector<double> whitened(std::span<const double> torque_nm) const;

  private:
    struct Run {
        std::size_t first, count;  ///< samples that follow each other, and all count
    };

    void whiten(std::span<const double> torque_nm, double* white) const;
    [[nodiscard]] std::vector<double> bridged(std::span<const double> torque_nm) const;
    std::vector<std::size_t> rows_;
    std::vector<Run> runs_;  ///< the same rows
    std::vector<Run> gaps_;  ///< samples that hold no torque
    std::vector<double> color_;
    std::size_t bounded_ = 0;
    std::vector<double> basis_;  ///< orthonormal columns of size() each
};

}  // namespace ripplenotch
