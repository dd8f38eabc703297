// SPDX-License-Identifier: MIT
#include "analysis/kernels/envelope_kernel.hpp"

#include <Eigen/Sparse>
#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "core/matrices/linear_algebra.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

using Sparse = Eigen::SparseMatrix<double>;

/// The mean of data between points: every sample weighs its two neighbours by nearness. At one sample a point
/// samples sit on the points.
Sparse mass_matrix(Eigen::Index points, double samples_per_point) {
    std::vector<Eigen::Triplet<double>> entries;
    const double q = samples_per_point;
    const double own = (2.0 + 1.0 / (q * q)) / 3.0, next = (1.0 - 1.0 / (q * q)) / 6.0;
    const auto add = [&](Eigen::Index i, Eigen::Index j, double v) {
        entries.emplace_back(static_cast<int>(i), static_cast<int>(j), v);
    };
    for (Eigen::Index j = 0; j < points; ++j) {
        const bool end = j == 0 || j + 1 == points;
        add(j, j, end && q > 1.0 ? 0.5 * (own + 1.0 / q) : own);
        if (j + 1 < points) {
            add(j, j + 1, next);
            add(j + 1, j, next);
        }
    }
    Sparse mass(points, points);
    mass.setFromTriplets(entries.begin(), entries.end());
    return mass;
}

Sparse differences(Eigen::Index points, int order) {
    Sparse product(points, points);
    product.setIdentity();
    for (int i = 0; i < order; ++i) {
        const Eigen::Index rows = product.rows() - 1;
        Sparse step(rows, rows + 1);
        std::vector<Eigen::Triplet<double>> entries;
        for (Eigen::Index j = 0; j < rows; ++j) {
            entries.emplace_back(static_cast<int>(j), static_cast<int>(j), -1.0);
            entries.emplace_back(static_cast<int>(j), static_cast<int>(j + 1), 1.0);
        }
        step.setFromTriplets(entries.begin(), entries.end());
        product = Sparse(step * product);
    }
    return product;
}

/// |sum of kernel times a rotation of `turn` a point|, straight lines between points included.
double gain_at(const Eigen::VectorXd& kernel, const Sparse& mass, double turn) {
    const Eigen::VectorXd seen = mass * kernel;
    std::complex<double> sum;
    for (Eigen::Index j = 0; j < seen.size(); ++j)
        sum += seen[j] * portable::polar(1.0, turn * static_cast<double>(j));
    return std::abs(sum);
}

/// First turn a point at which the gain falls to 1 / sqrt 2, searched upwards from 0.
double half_width(const Eigen::VectorXd& kernel, const Sparse& mass, double about) {
    const double level = 1.0 / std::numbers::sqrt2;
    double below = 0.0, above = 0.0;
    do {
        below = above;
        above += 0.05 * about;
    } while (above < std::numbers::pi && gain_at(kernel, mass, above) > level);
    for (int i = 0; i < 50; ++i) {
        const double middle = 0.5 * (below + above);
        (gain_at(kernel, mass, middle) > level ? below : above) = middle;
    }
    return 0.5 * (below + above);
}

}  // namespace

EnvelopeKernel::EnvelopeKernel(const EnvelopeSettings& settings, double duration_s, Hertz asked_bandwidth) {
    // Twice the overlap: from there on a longer run changes nothing in its middle.
    const double wanted = std::ceil(duration_s / settings.step_s) + 1.0;
    const auto points =
        static_cast<Eigen::Index>(std::min(wanted, 2.0 * static_cast<double>(settings.overlap_points) + 1.0));
    const Sparse mass = mass_matrix(points, settings.samples_per_point);
    const Sparse difference = differences(points, settings.poles);
    const Sparse matrix =
        mass + settings.weight * settings.weight * Sparse(Sparse(difference.transpose()) * difference);
    const Eigen::SimplicialLDLT<Sparse, Eigen::Lower, Eigen::NaturalOrdering<int>> solver(matrix);
    const auto kernel_of = [&](Eigen::Index point) {
        Eigen::VectorXd unit = Eigen::VectorXd::Zero(points);
        unit[point] = 1.0;
        return Eigen::VectorXd(solver.solve(unit));
    };
    const Eigen::VectorXd middle = kernel_of(points / 2);
    const double about = std::numbers::pi * asked_bandwidth.value() * settings.step_s;
    bandwidth_ = Hertz(half_width(middle, mass, about) / (std::numbers::pi * settings.step_s));
    freedom_per_sample_ = (mass * middle)[points / 2] / settings.samples_per_point;
    const Eigen::Index ends = std::min<Eigen::Index>(
        points / 2, static_cast<Eigen::Index>(2.0 / (asked_bandwidth.value() * settings.step_s)));
    for (Eigen::Index j = 0; j <= ends; ++j) {
        const Eigen::VectorXd kernel = j == ends ? middle : kernel_of(j);
        error_factors_.push_back(std::sqrt(2.0 / settings.samples_per_point * kernel.dot(mass * kernel)));
    }
}

}  // namespace ripplenotch
