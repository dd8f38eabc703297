// SPDX-License-Identifier: MIT
#pragma once
// The coordinates in which a fit moves: a value, its logarithm, or one of the two Cartesian parts of a size
// and a phase.

#include <optional>
#include <vector>

#include "ripplenotch/model/fit.hpp"

namespace ripplenotch {

enum class CoordinateKind { plain, logarithm, cosine_part, sine_part };

struct Coordinate {
    CoordinateKind kind;
    std::size_t term, parameter;  ///< of a pair: the size
    std::size_t phase;            ///< of a pair
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
    /// Values with their errors. `covariance` is row by row; a negative variance says "not told".
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

}  // namespace ripplenotch
