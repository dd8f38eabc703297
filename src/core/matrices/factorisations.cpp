// SPDX-License-Identifier: MIT
#include "core/matrices/factorisations.hpp"

namespace ripplenotch {

using Eigen::Index, Eigen::MatrixXd, Eigen::MatrixXcd, Eigen::VectorXd, Eigen::VectorXcd;

SymmetricFactors::SymmetricFactors(const MatrixXd& matrix) : factored_(matrix) {}
void SymmetricFactors::compute(const MatrixXd& matrix) { factored_.compute(matrix); }
double SymmetricFactors::least_pivot() const { return factored_.vectorD().minCoeff(); }
VectorXd SymmetricFactors::solve(const VectorXd& right) const { return factored_.solve(right); }
MatrixXd SymmetricFactors::solve(const MatrixXd& right) const { return factored_.solve(right); }

DefiniteFactors::DefiniteFactors(const MatrixXd& matrix) : factored_(matrix) {}
MatrixXd DefiniteFactors::lower() const { return factored_.matrixL(); }
VectorXd DefiniteFactors::solve(const VectorXd& right) const { return factored_.solve(right); }
MatrixXd DefiniteFactors::solve(const MatrixXd& right) const { return factored_.solve(right); }

ScaledDefiniteFactors::ScaledDefiniteFactors(MatrixXd matrix, double least)
    : scale_(matrix.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse()) {
    matrix = scale_.asDiagonal() * matrix * scale_.asDiagonal();
    matrix.diagonal().array() += least;
    factored_ = DefiniteFactors(matrix);
}
VectorXd ScaledDefiniteFactors::solve(const VectorXd& right) const {
    return scale_.cwiseProduct(factored_.solve(VectorXd(scale_.cwiseProduct(right))));
}

HermitianFactors::HermitianFactors(const MatrixXcd& matrix) : factored_(matrix) {}
MatrixXcd HermitianFactors::solve(const MatrixXcd& right) const { return factored_.solve(right); }

SquareFactors::SquareFactors(const MatrixXd& matrix) : factored_(matrix) {}
MatrixXd SquareFactors::solve(const MatrixXd& right) const { return factored_.solve(right); }

OrthogonalFactors::OrthogonalFactors(const MatrixXd& matrix) : factored_(matrix) {}
MatrixXd OrthogonalFactors::triangle() const {
    return factored_.matrixQR().topRows(factored_.cols()).triangularView<Eigen::Upper>();
}
VectorXd OrthogonalFactors::reached(const VectorXd& right) const {
    return (factored_.householderQ().transpose() * right).head(factored_.cols());
}
VectorXd OrthogonalFactors::solve(const VectorXd& right) const { return factored_.solve(right); }

RankedFactors::RankedFactors(const MatrixXd& matrix) : factored_(matrix) {}
Index RankedFactors::rank(double share) {
    factored_.setThreshold(share);
    return factored_.rank();
}
VectorXd RankedFactors::solve(const VectorXd& right) const { return factored_.solve(right); }

SingularDirections singular_directions(const MatrixXd& square) {
    // What goes before takes rows that are more than columns away, and there are none.
    const Eigen::JacobiSVD<MatrixXd, Eigen::NoQRPreconditioner> svd(square, Eigen::ComputeFullV);
    return {svd.matrixV(), svd.singularValues()};
}

VectorXcd eigenvalues(const MatrixXd& matrix) { return matrix.eigenvalues(); }

}  // namespace ripplenotch
