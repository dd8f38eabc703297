// SPDX-License-Identifier: MIT
#include "ripplenotch/model/fit.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "model/fit_coordinates.hpp"
#include "ripplenotch/core/error.hpp"

namespace ripplenotch {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// A column of the scaled Jacobian with less than this of its length outside the others is not told from them.
constexpr double not_told = 1e-7;
// Improvement of the sum of squares at which a search ends, relative.
constexpr double settled = 1e-9;

class Problem {
  public:
    Problem(const Model& model, const Motion& motion, std::span<const double> torque_nm,
            const FitOptions& options)
        : coordinates(model, options.first_guess), motion_(motion), torque_nm_(torque_nm), options_(options) {
        const std::size_t behind = options.noise_color.size();
        std::size_t since_unused = 0;
        for (std::size_t k = 0; k < torque_nm.size(); ++k) {
            const bool used = options.use.empty() || options.use[k] != 0;
            since_unused = used ? since_unused + 1 : 0;
            if (since_unused > behind) rows_.push_back(k);
        }
        if (rows_.size() <= coordinates.list().size()) {
            raise<UsageError>("{} samples are too few to fit {} values", rows_.size(),
                              coordinates.list().size());
        }
    }

    // Whitened measured less predicted torque of the samples used.
    [[nodiscard]] VectorXd residual(const std::vector<double>& point) const {
        std::vector<double> left = predict_nm(coordinates.at(point), motion_);
        for (std::size_t k = 0; k < left.size(); ++k) left[k] = torque_nm_[k] - left[k];
        VectorXd whitened(static_cast<Index>(rows_.size()));
        for (std::size_t r = 0; r < rows_.size(); ++r) {
            double value = left[rows_[r]];
            for (std::size_t i = 0; i < options_.noise_color.size(); ++i)
                value -= options_.noise_color[i] * left[rows_[r] - i - 1];
            whitened[static_cast<Index>(r)] = value;
        }
        return whitened;
    }

    // Change of the residual with each coordinate: exact for linear ones, central differences for the others.
    [[nodiscard]] MatrixXd slopes(const std::vector<double>& point, const VectorXd& here,
                                  const std::vector<std::size_t>& moving) const {
        MatrixXd columns(here.size(), static_cast<Index>(moving.size()));
        for (std::size_t m = 0; m < moving.size(); ++m) {
            const Coordinate& coordinate = coordinates.list()[moving[m]];
            std::vector<double> up = point, down = point;
            up[moving[m]] = std::min(point[moving[m]] + coordinate.step, coordinate.upper);
            if (!coordinate.linear)
                down[moving[m]] = std::max(point[moving[m]] - coordinate.step, coordinate.lower);
            const double width = up[moving[m]] - down[moving[m]];
            columns.col(static_cast<Index>(m)) =
                ((coordinate.linear ? here : residual(down)) - residual(up)) / width;
        }
        return columns;
    }

    Coordinates coordinates;

  private:
    const Motion& motion_;
    std::span<const double> torque_nm_;
    const FitOptions& options_;
    std::vector<std::size_t> rows_;
};

// The triangle of an orthogonal factorisation of the slopes, with each column scaled to length 1.
struct Factored {
    MatrixXd triangle;
    VectorXd target, scale;
};

Factored factor(MatrixXd slopes, const VectorXd& residual) {
    Factored factored;
    factored.scale = slopes.colwise().norm();
    for (Index c = 0; c < slopes.cols(); ++c) {
        if (factored.scale[c] > 0.0) slopes.col(c) /= factored.scale[c];
    }
    const Eigen::HouseholderQR<MatrixXd> qr(slopes);
    const Index m = slopes.cols();
    factored.triangle = qr.matrixQR().topRows(m).triangularView<Eigen::Upper>();
    factored.target = (qr.householderQ().transpose() * residual).head(m);
    return factored;
}

// The step that lowers |slopes * step - residual|^2 + damping * |scaled step|^2 most.
VectorXd damped_step(const Factored& factored, double damping) {
    const Index m = factored.triangle.cols();
    MatrixXd stacked(2 * m, m);
    stacked << factored.triangle, std::sqrt(damping) * MatrixXd::Identity(m, m);
    VectorXd target = VectorXd::Zero(2 * m);
    target.head(m) = factored.target;
    VectorXd step = stacked.householderQr().solve(target);
    for (Index c = 0; c < m; ++c) step[c] = factored.scale[c] > 0.0 ? step[c] / factored.scale[c] : 0.0;
    return step;
}

// Coordinates that may move: all but those at a bound whose best step leads out of it.
std::vector<std::size_t> free_to_move(const Problem& problem, const std::vector<double>& point,
                                      const VectorXd& residual, bool only_linear) {
    std::vector<std::size_t> moving;
    const auto& list = problem.coordinates.list();
    for (std::size_t c = 0; c < list.size(); ++c) {
        if (only_linear && !list[c].linear) continue;
        const bool low = point[c] <= list[c].lower, high = point[c] >= list[c].upper;
        if (low || high) {
            const double downhill = problem.slopes(point, residual, {c}).col(0).dot(residual);
            if ((low && downhill <= 0.0) || (high && downhill >= 0.0)) continue;
        }
        moving.push_back(c);
    }
    return moving;
}

struct Search {
    std::vector<double> point;
    VectorXd residual;
    int iterations = 0;
    bool converged = false;
};

std::vector<double> moved(const Problem& problem, std::vector<double> point,
                          const std::vector<std::size_t>& moving, const VectorXd& step) {
    for (std::size_t m = 0; m < moving.size(); ++m) {
        const Coordinate& coordinate = problem.coordinates.list()[moving[m]];
        double& value = point[moving[m]];
        value = std::clamp(value + step[static_cast<Index>(m)], coordinate.lower, coordinate.upper);
    }
    return point;
}

void descend(const Problem& problem, Search& search, bool only_linear, int most_iterations) {
    double damping = 1e-9;
    search.converged = false;
    for (int i = 0; i < most_iterations && !search.converged; ++i) {
        const auto moving = free_to_move(problem, search.point, search.residual, only_linear);
        if (moving.empty()) {
            search.converged = true;
            return;
        }
        ++search.iterations;
        const Factored factored =
            factor(problem.slopes(search.point, search.residual, moving), search.residual);
        const double before = search.residual.squaredNorm();
        while (true) {
            auto point = moved(problem, search.point, moving, damped_step(factored, damping));
            VectorXd residual = problem.residual(point);
            const double after = residual.squaredNorm();
            if (after < before) {
                search.converged = before - after <= settled * before;
                search.point = std::move(point);
                search.residual = std::move(residual);
                damping = std::max(damping / 10.0, 1e-12);
                break;
            }
            damping *= 10.0;
            if (damping > 1e6) {  // not a step of any length lowers it: this is the minimum
                search.converged = true;
                break;
            }
        }
    }
}

// Row by row; -1 for what the log does not tell.
std::vector<double> covariance_at(const Problem& problem, const Search& search) {
    const std::size_t n = problem.coordinates.list().size();
    std::vector<double> covariance(n * n, -1.0);
    const auto moving = free_to_move(problem, search.point, search.residual, false);
    if (moving.empty()) return covariance;
    const Factored factored = factor(problem.slopes(search.point, search.residual, moving), search.residual);
    const Index m = static_cast<Index>(moving.size());
    const double variance = search.residual.squaredNorm() / static_cast<double>(search.residual.size() - m);
    // Small singular values belong to combinations that the log does not tell; what takes part in one is
    // unknown.
    const Eigen::JacobiSVD<MatrixXd> svd(factored.triangle, Eigen::ComputeFullV);
    MatrixXd inverse = MatrixXd::Zero(m, m);
    VectorXd unknown = VectorXd::Zero(m);
    for (Index i = 0; i < m; ++i) {
        const VectorXd direction = svd.matrixV().col(i);
        const double length = svd.singularValues()[i];
        if (length < not_told) {
            unknown += direction.cwiseAbs2();
        } else {
            inverse += direction * direction.transpose() / (length * length);
        }
    }
    for (Index a = 0; a < m; ++a) {
        for (Index b = 0; b < m; ++b) {
            if (unknown[a] > 1e-6 || unknown[b] > 1e-6) continue;
            covariance[moving[static_cast<std::size_t>(a)] * n + moving[static_cast<std::size_t>(b)]] =
                variance * inverse(a, b) / (factored.scale[a] * factored.scale[b]);
        }
    }
    return covariance;
}

}  // namespace

Fit fit(const Model& model, const Motion& motion, std::span<const double> torque_nm,
        const FitOptions& options) {
    const Problem problem(model, motion, torque_nm, options);
    Search search;
    for (const Coordinate& coordinate : problem.coordinates.list()) search.point.push_back(coordinate.start);
    search.residual = problem.residual(search.point);
    // What is linear is right for the first guess of the rest before the rest moves.
    descend(problem, search, true, 2);
    descend(problem, search, false, options.most_iterations);
    Fit found;
    found.model = problem.coordinates.at(search.point);
    for (std::size_t i = 0; i < model.terms.size(); ++i) {
        if (model.terms[i].effect->chance) found.model.terms[i] = model.terms[i];
    }
    found.values = problem.coordinates.values(search.point, covariance_at(problem, search));
    found.samples = static_cast<std::size_t>(search.residual.size());
    found.residual_rms_nm = std::sqrt(search.residual.squaredNorm() / static_cast<double>(found.samples));
    found.iterations = search.iterations;
    found.converged = search.converged;
    return found;
}

std::vector<double> torque_per_unit(const Model& model, std::size_t term, std::size_t parameter,
                                    const Motion& motion) {
    Model with = model, without = model;
    with.terms.at(term).values.at(parameter) = 1.0;
    without.terms.at(term).values.at(parameter) = 0.0;
    std::vector<double> torque_nm = predict_nm(with, motion);
    const auto rest_nm = predict_nm(without, motion);
    for (std::size_t k = 0; k < torque_nm.size(); ++k) torque_nm[k] -= rest_nm[k];
    return torque_nm;
}

}  // namespace ripplenotch
