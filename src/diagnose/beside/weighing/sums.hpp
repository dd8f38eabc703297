// SPDX-License-Identifier: MIT
#pragma once
// Sums of products by fold of everything that was weighed, so that a set of names costs one small solution
// for each fold.

#include <map>
#include <utility>
#include <vector>

#include "core/matrices/linear_algebra.hpp"
#include "diagnose/beside/weighing/shape_columns.hpp"

namespace ripplenotch {

/// Places in Sums::shapes().
using Names = std::vector<std::size_t>;

class Sums {
  public:
    /// All of lens.shapes(), in their order. `lens` must outlive it.
    explicit Sums(const Lens& lens);

    [[nodiscard]] const Lens& lens() const { return lens_; }
    [[nodiscard]] const std::vector<Shape>& shapes() const { return columns_.shapes(); }
    /// How many of them are the lens' own; the others are refined.
    [[nodiscard]] std::size_t listed() const { return lens_.shapes().size(); }
    /// Its place; weighed when it is new.
    std::size_t place_of(const Shape& shape);
    /// Forgets refined shapes that are in none of `kept`, whose places change.
    void forget_but(Names& kept);
    /// False when the always-on columns leave next to nothing of it: the log does not tell it.
    [[nodiscard]] bool is_told(std::size_t shape) const;

    /// Cross-validated sum of squares: each fold with sizes from the others.
    [[nodiscard]] double left_outside(const Names& names) const;
    /// The residual that is so squared, a value per row.
    [[nodiscard]] std::vector<double> residual_outside(const Names& names) const;
    /// The same of another target, a value per row of the lens.
    [[nodiscard]] std::vector<double> residual_outside(const Names& names, std::vector<double> target) const;
    /// Sizes, a number per column of the names in order, from all folds.
    [[nodiscard]] Eigen::VectorXd sizes(const Names& names) const;
    /// Sums of all folds, a row and column per column of the names.
    [[nodiscard]] Eigen::MatrixXd products(const Names& names) const;
    [[nodiscard]] Eigen::MatrixXd products(const Names& names, std::size_t fold) const;
    [[nodiscard]] Eigen::VectorXd targets(const Names& names, std::size_t fold) const;
    [[nodiscard]] std::size_t folds() const { return lens_.ground().folds().size(); }
    using Column = ShapeColumns::Column;
    /// All of the shape's columns, weighed once more where a refined one's are held no longer.
    [[nodiscard]] std::vector<Column> weighed(std::size_t shape) const;

  private:
    using ByFold = std::vector<Eigen::MatrixXd>;
    /// Shapes whose own columns, one after the other, are those of the names.
    [[nodiscard]] Names parts_of(const Names& names) const;
    const ByFold& pair(std::size_t a, std::size_t b) const;
    void add(const Shape& shape);
    [[nodiscard]] Eigen::VectorXd solved(const Eigen::MatrixXd& products,
                                         const Eigen::VectorXd& targets) const;

    const Lens& lens_;
    ShapeColumns columns_;
    std::vector<std::vector<Eigen::VectorXd>> targets_;  ///< by shape and fold, of its own columns
    std::vector<double> target_squares_;                 ///< by fold
    mutable std::map<std::pair<std::size_t, std::size_t>, ByFold> pairs_;
};

}  // namespace ripplenotch
