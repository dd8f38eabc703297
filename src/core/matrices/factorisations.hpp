// SPDX-License-Identifier: MIT
#pragma once
// Eigen's factorisations, each made once for the whole library: made anew in every file that used one, each
// took 2 to 8 CPU seconds of compiling there.

#include "core/matrices/linear_algebra.hpp"

namespace ripplenotch {

/// L D L' of a symmetric matrix, of which the lower half is read; it may be singular.
class SymmetricFactors {
  public:
    SymmetricFactors() = default;
    explicit SymmetricFactors(const Eigen::MatrixXd& matrix);

    void compute(const Eigen::MatrixXd& matrix);
    [[nodiscard]] double least_pivot() const;  ///< of D
    [[nodiscard]] Eigen::VectorXd solve(const Eigen::VectorXd& right) const;
    [[nodiscard]] Eigen::MatrixXd solve(const Eigen::MatrixXd& right) const;

  private:
    Eigen::LDLT<Eigen::MatrixXd> factored_;
};

/// L L' of a positive definite matrix, of which the lower half is read.
class DefiniteFactors {
  public:
    DefiniteFactors() = default;
    explicit DefiniteFactors(const Eigen::MatrixXd& matrix);

    [[nodiscard]] Eigen::MatrixXd lower() const;
    [[nodiscard]] Eigen::VectorXd solve(const Eigen::VectorXd& right) const;
    [[nodiscard]] Eigen::MatrixXd solve(const Eigen::MatrixXd& right) const;

  private:
    Eigen::LLT<Eigen::MatrixXd> factored_;
};

/// The same of a matrix whose unknowns may have any units: each is scaled to a diagonal of 1, to which
/// `least` is added, so that a matrix that is singular but for rounding shares between equal unknowns.
class ScaledDefiniteFactors {
  public:
    ScaledDefiniteFactors() = default;
    ScaledDefiniteFactors(Eigen::MatrixXd matrix, double least);

    [[nodiscard]] Eigen::VectorXd solve(const Eigen::VectorXd& right) const;

  private:
    Eigen::VectorXd scale_;
    DefiniteFactors factored_;
};

/// L D L* of a Hermitian matrix, of which the lower half is read; it may be singular.
class HermitianFactors {
  public:
    explicit HermitianFactors(const Eigen::MatrixXcd& matrix);
    [[nodiscard]] Eigen::MatrixXcd solve(const Eigen::MatrixXcd& right) const;

  private:
    Eigen::LDLT<Eigen::MatrixXcd> factored_;
};

/// L U of any square matrix that is not singular.
class SquareFactors {
  public:
    explicit SquareFactors(const Eigen::MatrixXd& matrix);

    [[nodiscard]] Eigen::MatrixXd solve(const Eigen::MatrixXd& right) const;

  private:
    Eigen::PartialPivLU<Eigen::MatrixXd> factored_;
};

/// Q R of at least as many rows as columns, none of which is a combination of others.
class OrthogonalFactors {
  public:
    explicit OrthogonalFactors(const Eigen::MatrixXd& matrix);

    [[nodiscard]] Eigen::MatrixXd triangle() const;  ///< the square of R that is not 0
    /// The numbers of Q' `right` that the columns can reach, one for each.
    [[nodiscard]] Eigen::VectorXd reached(const Eigen::VectorXd& right) const;
    /// By which the columns are nearest to `right`.
    [[nodiscard]] Eigen::VectorXd solve(const Eigen::VectorXd& right) const;

  private:
    Eigen::HouseholderQR<Eigen::MatrixXd> factored_;
};

/// The same with columns in the order of what each adds; they may be combinations of each other.
class RankedFactors {
  public:
    explicit RankedFactors(const Eigen::MatrixXd& matrix);

    /// Columns that add more than this share of what the first one does.
    [[nodiscard]] Eigen::Index rank(double share);
    /// By which the columns are nearest to `right`; the smallest such values where there are several.
    [[nodiscard]] Eigen::VectorXd solve(const Eigen::VectorXd& right) const;

  private:
    Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> factored_;
};

/// The directions, each a column, that a square matrix turns into others at right angles, and how long it
/// makes them.
struct SingularDirections {
    Eigen::MatrixXd directions;
    Eigen::VectorXd lengths;
};
[[nodiscard]] SingularDirections singular_directions(const Eigen::MatrixXd& square);

/// The eigenvalues of a square matrix, conjugates next to each other.
[[nodiscard]] Eigen::VectorXcd eigenvalues(const Eigen::MatrixXd& matrix);

}  // namespace ripplenotch
