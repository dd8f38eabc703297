// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "core/matrices/factorisations.hpp"
#include "core/matrices/least_squares.hpp"
#include "core/vectors/dot.hpp"
#include "model/carriers.hpp"
#include "model/fit/weighing.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/model/fit.hpp"
#include "ripplenotch/model/prediction.hpp"

namespace ripplenotch {

namespace {

// Standard errors of the coordinates of a fit.

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Slopes = Eigen::Map<const MatrixXd>;

// A column of the scaled Jacobian with less than this of its length outside the others is collinear with
// them.
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
    // The pulls sum to zero: fewer stretches than this are insufficient to estimate their spread.
    if (stretches < 3 * m) return factor;
    spread *= static_cast<double>(stretches) / static_cast<double>(stretches - m);
    const MatrixXd robust = inverse * spread * inverse;
    for (Index c = 0; c < m; ++c) {
        const double white = variance * inverse(c, c);
        if (white > 0.0) factor[c] = std::sqrt(std::max(1.0, robust(c, c) / white));
    }
    return factor;
}

// Inverse of the normal matrix for slopes of length 1, and the coordinates that are not identifiable from
// them.
struct Told {
    MatrixXd inverse;
    VectorXd unknown;
};

// Small singular values belong to combinations that are not identifiable; every coordinate in one is unknown.
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

// Covariance of coordinates whose slopes along the fitted rows stand one after another in `slopes`, each as
// long as `residual`; row by row, -1 where one of the two is not identifiable. `stretch`: samples in a
// stretch of the log over which noise is correlated, 0 for white noise.
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

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// A point with what has been computed there.
struct Place {
    std::vector<double> point;
    Prediction prediction;
    VectorXd residual;  ///< weighed, measured less predicted
    double squares;     ///< their sum
};

class Problem {
  public:
    Problem(const Model& model, const Motion& motion, std::span<const double> torque_nm,
            const FitOptions& options, const Weighing& weighing)
        : coordinates(model, options.first_guess),
          motion_(motion),
          torque_nm_(torque_nm),
          weighing_(weighing),
          carriers_(options.carriers != nullptr ? options.carriers : &own_carriers_) {
        const std::size_t samples = weighing.rows().size(), values = coordinates.list().size();
        if (samples <= values + weighing.used_up())
            raise<UsageError>("{} samples are too few to fit {} values", samples, values);
    }

    [[nodiscard]] Place at(std::vector<double> point) const {
        Prediction prediction(coordinates.at(point), motion_, carriers_);
        applied_ += prediction.applied();
        std::vector<double> left = prediction.torque_nm();
        for (std::size_t k = 0; k < left.size(); ++k) left[k] = torque_nm_[k] - left[k];
        VectorXd residual(static_cast<Index>(weighing_.size()));
        weighing_.weigh(left, residual.data());
        const double squares = dot(residual.data(), residual.data(), weighing_.size());
        return {std::move(point), std::move(prediction), std::move(residual), squares};
    }

    // Change of the residual with each coordinate: exact for linear ones, central differences for the others.
    [[nodiscard]] MatrixXd slopes(const Place& place, const std::vector<std::size_t>& moving) const {
        MatrixXd columns(place.residual.size(), static_cast<Index>(moving.size()));
        const std::size_t before = place.prediction.applied();
        for (std::size_t m = 0; m < moving.size(); ++m) {
            weighing_.weigh(slope_nm(place.prediction, coordinates, place.point, moving[m]),
                            columns.col(static_cast<Index>(m)).data());
        }
        applied_ += place.prediction.applied() - before;
        return columns;
    }

    [[nodiscard]] std::size_t applied() const { return applied_; }

    Coordinates coordinates;

  private:
    const Motion& motion_;
    std::span<const double> torque_nm_;
    const Weighing& weighing_;
    Carriers own_carriers_;
    Carriers* carriers_;
    mutable std::size_t applied_ = 0;
};

// The triangle of an orthogonal factorisation of the slopes, with each column scaled to length 1.
struct Factored {
    MatrixXd triangle;
    VectorXd target, scale;
};

Factored factor(const MatrixXd& slopes, const VectorXd& residual) {
    const Index count = slopes.cols();
    const TallTriangle found = tall_triangle({slopes.data(), static_cast<std::size_t>(slopes.size())},
                                             {residual.data(), static_cast<std::size_t>(residual.size())});
    Factored factored{Eigen::Map<const MatrixXd>(found.triangle.data(), count, count),
                      Eigen::Map<const VectorXd>(found.reached.data(), count),
                      {}};
    factored.scale = factored.triangle.colwise().norm();
    for (Index c = 0; c < count; ++c) {
        if (factored.scale[c] > 0.0) factored.triangle.col(c) /= factored.scale[c];
    }
    return factored;
}

// The step that lowers |slopes * step - residual|^2 + damping * |scaled step|^2 most.
VectorXd damped_step(const Factored& factored, double damping) {
    const Index m = factored.triangle.cols();
    MatrixXd stacked(2 * m, m);
    stacked << factored.triangle, std::sqrt(damping) * MatrixXd::Identity(m, m);
    VectorXd target = VectorXd::Zero(2 * m);
    target.head(m) = factored.target;
    VectorXd step = OrthogonalFactors(stacked).solve(target);
    for (Index c = 0; c < m; ++c) step[c] = factored.scale[c] > 0.0 ? step[c] / factored.scale[c] : 0.0;
    return step;
}

// Coordinates that may move: all but those at a bound whose best step leads out of it.
std::vector<std::size_t> free_to_move(const Problem& problem, const Place& place, bool only_linear) {
    std::vector<std::size_t> moving;
    const auto& list = problem.coordinates.list();
    for (std::size_t c = 0; c < list.size(); ++c) {
        if (only_linear && !list[c].linear) continue;
        const bool low = place.point[c] <= list[c].lower, high = place.point[c] >= list[c].upper;
        if (low || high) {
            const MatrixXd slope = problem.slopes(place, {c});
            const double downhill =
                dot(slope.data(), place.residual.data(), static_cast<std::size_t>(slope.size()));
            if ((low && downhill <= 0.0) || (high && downhill >= 0.0)) continue;
        }
        moving.push_back(c);
    }
    return moving;
}

struct Search {
    Place place;
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

// One step from here: the first of successively shorter ones that lowers the sum of squares. Returns false
// when none does.
bool step_down(const Problem& problem, Search& search, const std::vector<std::size_t>& moving,
               double& damping) {
    const Factored factored = factor(problem.slopes(search.place, moving), search.place.residual);
    const double before = search.place.squares;
    for (; damping <= 1e6; damping *= 10.0) {
        Place next = problem.at(moved(problem, search.place.point, moving, damped_step(factored, damping)));
        if (!(next.squares < before)) continue;  // not a number neither: a step from collinear slopes
        search.place = std::move(next);
        damping = std::max(damping / 10.0, 1e-12);
        return true;
    }
    return false;
}

void descend(const Problem& problem, Search& search, bool only_linear, const FitOptions& options) {
    double damping = 1e-12;
    search.converged = false;
    const auto& list = problem.coordinates.list();
    for (int i = 0; i < options.most_iterations && !search.converged; ++i) {
        const auto moving = free_to_move(problem, search.place, only_linear);
        if (moving.empty()) {
            search.converged = true;
            return;
        }
        ++search.iterations;
        const double before = search.place.squares;
        const bool lower = step_down(problem, search, moving, damping);
        const double gained = before - search.place.squares;
        // One step solves the linear values, unless a bound cut it short.
        const bool solved = std::all_of(moving.begin(), moving.end(), [&](std::size_t c) {
            return list[c].linear && search.place.point[c] > list[c].lower &&
                   search.place.point[c] < list[c].upper;
        });
        search.converged = !lower || gained <= options.settled * before || solved;
    }
}

// Row by row; -1 where a coordinate is not identifiable.
std::vector<double> covariance_at(const Problem& problem, const Search& search, const Weighing& weighing,
                                  const FitOptions& options) {
    const std::size_t n = problem.coordinates.list().size();
    std::vector<double> covariance(n * n, -1.0);
    if (!options.errors) return covariance;
    const auto moving = free_to_move(problem, search.place, false);
    if (moving.empty()) return covariance;
    const MatrixXd slopes = problem.slopes(search.place, moving);
    const VectorXd& residual = search.place.residual;
    const std::size_t m = moving.size();
    const auto of_moving = covariance_of({slopes.data(), static_cast<std::size_t>(slopes.size())},
                                         {residual.data(), static_cast<std::size_t>(residual.size())},
                                         weighing, options.error_stretch);
    for (std::size_t a = 0; a < m; ++a) {
        for (std::size_t b = 0; b < m; ++b) covariance[moving[a] * n + moving[b]] = of_moving[a * m + b];
    }
    return covariance;
}

}  // namespace

std::vector<double> slope_nm(const Prediction& prediction, const Coordinates& coordinates,
                             const std::vector<double>& point, std::size_t c) {
    const Coordinate& coordinate = coordinates.list()[c];
    const auto at = [&](double value) {
        std::vector<double> other = point;
        other[c] = value;
        return prediction.changed(coordinate.term, coordinates.at(other).terms[coordinate.term]);
    };
    double up = std::min(point[c] + coordinate.step, coordinate.upper);
    // At its upper bound a linear value has the slope of a step down.
    if (coordinate.linear && !(up > point[c])) up = point[c] - coordinate.step;
    const double down = coordinate.linear ? point[c] : std::max(point[c] - coordinate.step, coordinate.lower);
    std::vector<double> slope = at(up);
    if (!coordinate.linear) add_scaled(-1.0, at(down).data(), slope.data(), slope.size());
    const double by_step = 1.0 / (up - down);
    if (by_step == 1.0) return slope;
    for (double& value : slope) value *= by_step;
    return slope;
}

Fit fit(const Model& model, const Motion& motion, std::span<const double> torque_nm,
        const FitOptions& options) {
    const Weighing own(torque_nm.size(), options.use, options.noise_color);
    const Weighing& weighing = options.weighing != nullptr ? *options.weighing : own;
    const Problem problem(model, motion, torque_nm, options, weighing);
    std::vector<double> start;
    for (const Coordinate& coordinate : problem.coordinates.list()) start.push_back(coordinate.start);
    Search search{problem.at(std::move(start))};
    // Linear values are solved for the first guess of the others before those move.
    FitOptions briefly = options;
    briefly.most_iterations = std::min(2, options.most_iterations);
    descend(problem, search, true, briefly);
    const auto& list = problem.coordinates.list();
    if (!std::all_of(list.begin(), list.end(), [](const Coordinate& c) { return c.linear; }))
        descend(problem, search, false, options);
    Fit found;
    found.model = problem.coordinates.at(search.place.point);
    for (std::size_t i = 0; i < model.terms.size(); ++i) {
        if (model.terms[i].effect->chance) found.model.terms[i] = model.terms[i];
    }
    found.samples = weighing.rows().size();
    found.values =
        problem.coordinates.values(search.place.point, covariance_at(problem, search, weighing, options));
    found.residual_rms_nm = std::sqrt(search.place.squares / static_cast<double>(found.samples));
    found.iterations = search.iterations;
    found.applied = problem.applied();
    found.converged = search.converged;
    return found;
}

}  // namespace ripplenotch
