// SPDX-License-Identifier: MIT
#include "model/fit/fit_errors.hpp"

#include <algorithm>
#include <cmath>

#include "core/matrices/factorisations.hpp"
#include "core/matrices/tall_triangle.hpp"

namespace ripplenotch {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Slopes = Eigen::Map<const MatrixXd>;

// A column of the scaled Jacobian with less than this of its length outside the others is not told from them.
constexpr double not_told = 1e-7;

// By how much each coordinate's error is larger than that of white noise, from the pull of the residual on it
// in each stretch of the log: stretches that pull the same way again and again are no white noise (the
// sandwich estimate of Huber and White, over blocks as of Kuensch, 1989). Never below 1. `inverse` belongs to
// slopes of length 1.
VectorXd inflation(const Slopes& slopes, const VectorXd& residual, const VectorXd& scale,
                   const MatrixXd& inverse, double variance, const Weighing& weighing, std::size_t stretch) {
    const Index m = slopes.cols();
    const std::vector<std::size_t>& rows = weighing.rows();
    MatrixXd spread = MatrixXd::Zero(m, m);
    Index stretches = 0;
    for (std::size_t r = 0; r < rows.size();) {
        VectorXd pull = VectorXd::Zero(m);
        for (const std::size_t here = rows[r] / stretch; r < rows.size() && rows[r] / stretch == here; ++r)
            pull += slopes.row(static_cast<Index>(r)).transpose() * residual[static_cast<Index>(r)];
        for (Index c = 0; c < m; ++c) pull[c] = scale[c] > 0.0 ? pull[c] / scale[c] : 0.0;
        spread += pull * pull.transpose();
        ++stretches;
    }
    VectorXd factor = VectorXd::Ones(m);
    // The pulls sum to nothing: fewer stretches than this tell little of their spread.
    if (stretches < 3 * m) return factor;
    spread *= static_cast<double>(stretches) / static_cast<double>(stretches - m);
    const MatrixXd robust = inverse * spread * inverse;
    for (Index c = 0; c < m; ++c) {
        const double white = variance * inverse(c, c);
        if (white > 0.0) factor[c] = std::sqrt(std::max(1.0, robust(c, c) / white));
    }
    return factor;
}

// What the slopes of length 1 tell of their coordinates, and which of these it does not tell.
struct Told {
    MatrixXd inverse;
    VectorXd unknown;
};

// Small singular values belong to combinations that the log does not tell; what takes part in one is unknown.
Told told_by(const MatrixXd& triangle) {
    const Index m = triangle.cols();
    const SingularDirections found = singular_directions(triangle);
    Told told{MatrixXd::Zero(m, m), VectorXd::Zero(m)};
    for (Index i = 0; i < m; ++i) {
        const VectorXd direction = found.directions.col(i);
        const double length = found.lengths[i];
        if (length < not_told) {
            told.unknown += direction.cwiseAbs2();
        } else {
            told.inverse += direction * direction.transpose() / (length * length);
        }
    }
    return told;
}

}  // namespace

std::vector<double> covariance_of(std::span<const double> slopes, std::span<const double> residual,
                                  const Weighing& weighing, std::size_t stretch) {
    const auto rows = static_cast<Index>(residual.size());
    const Slopes columns(slopes.data(), rows, static_cast<Index>(slopes.size()) / rows);
    const VectorXd left = Eigen::Map<const VectorXd>(residual.data(), rows);
    const Index m = columns.cols();
    MatrixXd triangle = Eigen::Map<const MatrixXd>(tall_triangle(slopes, residual).triangle.data(), m, m);
    const VectorXd scale = triangle.colwise().norm();
    for (Index c = 0; c < m; ++c) {
        if (scale[c] > 0.0) triangle.col(c) /= scale[c];
    }
    const Told told = told_by(triangle);
    const double samples = static_cast<double>(weighing.rows().size() - weighing.used_up());
    const double variance = left.squaredNorm() / (samples - static_cast<double>(m));
    VectorXd larger = VectorXd::Ones(m);
    if (stretch > 0) larger = inflation(columns, left, scale, told.inverse, variance, weighing, stretch);
    std::vector<double> covariance(static_cast<std::size_t>(m * m), -1.0);
    for (Index a = 0; a < m; ++a) {
        for (Index b = 0; b < m; ++b) {
            if (told.unknown[a] > 1e-6 || told.unknown[b] > 1e-6) continue;
            covariance[static_cast<std::size_t>(a * m + b)] =
                variance * larger[a] * larger[b] * told.inverse(a, b) / (scale[a] * scale[b]);
        }
    }
    return covariance;
}

}  // namespace ripplenotch
