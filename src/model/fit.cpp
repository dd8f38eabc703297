// SPDX-License-Identifier: MIT
#include "ripplenotch/model/fit.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "core/matrices/factorisations.hpp"
#include "core/matrices/least_squares.hpp"
#include "core/vectors/dot.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {

namespace {

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

constexpr double unbounded = 1e300;  // beyond any value

FittedValue told(std::size_t term, std::size_t parameter, double value, double variance, double per_unit) {
    FittedValue fitted;
    fitted.term = term;
    fitted.parameter = parameter;
    fitted.value = value;
    if (!(variance >= 0.0) || !std::isfinite(variance)) return fitted;
    const double error = std::sqrt(variance) * per_unit;
    fitted.standard_error = error;
    fitted.ci95 = Interval{value - normal_95_errors * error, value + normal_95_errors * error};
    return fitted;
}

Coordinates::Coordinates(const Model& model, const Model* first_guess)
    : model_(model), first_guess_(first_guess) {
    for (const Term& term : model.terms) {
        if (!term.effect->chance && !term.effect->linear_in_torque) sum_is_linear_ = false;
    }
    for (std::size_t i = 0; i < model_.terms.size(); ++i) {
        if (model_.terms[i].effect->chance) {
            // They act on no prediction, but a prediction needs their values.
            for (std::size_t p = 0; p < model_.terms[i].values.size(); ++p) {
                auto& value = model_.terms[i].values[p];
                value = value.value_or(model_.terms[i].effect->parameters[p].start);
            }
            continue;
        }
        add_term(i);
    }
}

double Coordinates::guess(std::size_t term, std::size_t parameter) const {
    const Parameter& described = model_.terms[term].effect->parameters[parameter];
    if (first_guess_ == nullptr) return described.start;
    return first_guess_->terms.at(term).values.at(parameter).value_or(described.start);
}

void Coordinates::add_term(std::size_t i) {
    const Term& term = model_.terms[i];
    const Effect& effect = *term.effect;
    const auto missing = [&](std::size_t p) { return !term.values[p]; };
    // Load enters some effects as a product or a power, so that the torque is not linear in the terms that
    // bear it.
    const bool load_is_used = std::any_of(model_.terms.begin(), model_.terms.end(),
                                          [](const Term& other) { return other.effect->uses_load; });
    const bool linear_term = effect.side == Side::joint && sum_is_linear_ &&
                             !(effect.bears_load && load_is_used) && !effect.uses_load;
    const bool pair = effect.polar && missing(effect.polar->size) && missing(effect.polar->phase);
    if (pair) {
        const auto [size, phase] = *effect.polar;
        const double amount = guess(i, size), angle_deg = guess(i, phase);
        const double step = linear_term ? 1.0 : 1e-6 * std::max(amount, effect.parameters[size].start);
        list_.push_back({CoordinateKind::cosine_part, i, size, phase,
                         amount * portable::cos_degrees(angle_deg), -unbounded, unbounded, step,
                         linear_term});
        list_.push_back({CoordinateKind::sine_part, i, size, phase, amount * portable::sin_degrees(angle_deg),
                         -unbounded, unbounded, step, linear_term});
    }
    for (std::size_t p = 0; p < effect.parameters.size(); ++p) {
        const Parameter& parameter = effect.parameters[p];
        if (!missing(p) || parameter.left_out == LeftOut::assumed) continue;
        if (parameter.left_out == LeftOut::refused) {
            raise<UsageError>("the model does not state effects[{}].{} of {}; a fit does not search for it",
                              i, parameter.name, effect.name);
        }
        if (pair && (p == effect.polar->size || p == effect.polar->phase)) continue;
        const double start = guess(i, p);
        if (parameter.logarithmic) {
            list_.push_back({CoordinateKind::logarithm, i, p, 0, portable::log(start),
                             portable::log(parameter.lower), portable::log(max_in(model_, effect, p)), 1e-5,
                             false});
            continue;
        }
        const bool linear = linear_term && parameter.linear;
        const double size = std::max(std::abs(start), std::abs(parameter.start));
        const double scale = size > 0.0 ? size : 1e-3;
        list_.push_back({CoordinateKind::plain, i, p, 0, start, min_in(model_, effect, p),
                         max_in(model_, effect, p), linear ? scale : 1e-5 * scale, linear});
    }
}

Model Coordinates::at(const std::vector<double>& point) const {
    Model model = model_;
    for (std::size_t c = 0; c < list_.size(); ++c) {
        const Coordinate& coordinate = list_[c];
        auto& values = model.terms[coordinate.term].values;
        if (coordinate.kind == CoordinateKind::plain) {
            values[coordinate.parameter] = point[c];
        } else if (coordinate.kind == CoordinateKind::logarithm) {
            values[coordinate.parameter] = portable::exp(point[c]);
        } else if (coordinate.kind == CoordinateKind::cosine_part) {
            values[coordinate.parameter] = portable::hypot(point[c], point[c + 1]);
            values[coordinate.phase] = portable::atan2(point[c + 1], point[c]) * degrees_per_radian;
        }
    }
    return model;
}

std::vector<FittedValue> Coordinates::values(const std::vector<double>& point,
                                             const std::vector<double>& covariance) const {
    const std::size_t n = list_.size();
    const auto variance = [&](std::size_t a, std::size_t b) { return covariance[a * n + b]; };
    std::vector<FittedValue> found;
    for (std::size_t c = 0; c < n; ++c) {
        const Coordinate& place = list_[c];
        if (place.kind == CoordinateKind::plain) {
            found.push_back(told(place.term, place.parameter, point[c], variance(c, c), 1.0));
            found.back().at_bound = point[c] <= place.lower || point[c] >= place.upper;
        } else if (place.kind == CoordinateKind::logarithm) {
            const double value = portable::exp(point[c]);
            found.push_back(told(place.term, place.parameter, value, variance(c, c), value));
            if (auto& ci95 = found.back().ci95) {
                const double half = normal_95_errors * std::sqrt(variance(c, c));
                ci95 = Interval{value * portable::exp(-half), value * portable::exp(half)};
            }
            found.back().at_bound = point[c] <= place.lower || point[c] >= place.upper;
        } else if (place.kind == CoordinateKind::cosine_part) {
            const double x = point[c], y = point[c + 1], size = portable::hypot(x, y);
            const double cosine = size > 0.0 ? x / size : 1.0, sine = size > 0.0 ? y / size : 0.0;
            const double xx = variance(c, c), xy = variance(c, c + 1), yy = variance(c + 1, c + 1);
            const double along = xx * cosine * cosine + 2.0 * xy * cosine * sine + yy * sine * sine;
            const double across = xx * sine * sine - 2.0 * xy * cosine * sine + yy * cosine * cosine;
            const bool known = xx >= 0.0 && yy >= 0.0;
            found.push_back(told(place.term, place.parameter, size, known ? along : -1.0, 1.0));
            found.push_back(told(place.term, place.phase, portable::atan2(y, x) * degrees_per_radian,
                                 known && size > 0.0 ? across : -1.0,
                                 degrees_per_radian / std::max(size, 1e-300)));
        }
    }
    std::sort(found.begin(), found.end(), [](const FittedValue& a, const FittedValue& b) {
        return std::pair(a.term, a.parameter) < std::pair(b.term, b.parameter);
    });
    return found;
}

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
                   const MatrixXd& inverse, double variance, const std::vector<std::size_t>& rows,
                   std::size_t stretch) {
    const Index m = slopes.cols();
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
                                  const std::vector<std::size_t>& rows, std::size_t stretch) {
    const auto samples = static_cast<Index>(residual.size());
    const Slopes columns(slopes.data(), samples, static_cast<Index>(slopes.size()) / samples);
    const VectorXd left = Eigen::Map<const VectorXd>(residual.data(), samples);
    const Index m = columns.cols();
    MatrixXd triangle = Eigen::Map<const MatrixXd>(tall_triangle(slopes, residual).triangle.data(), m, m);
    const VectorXd scale = triangle.colwise().norm();
    for (Index c = 0; c < m; ++c) {
        if (scale[c] > 0.0) triangle.col(c) /= scale[c];
    }
    const Told told = told_by(triangle);
    const double variance = left.squaredNorm() / static_cast<double>(samples - m);
    VectorXd larger = VectorXd::Ones(m);
    if (stretch > 0) larger = inflation(columns, left, scale, told.inverse, variance, rows, stretch);
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

// A point with what has been computed there.
struct Place {
    std::vector<double> point;
    VectorXd residual;  ///< of the samples that count, measured less predicted
    double squares;     ///< their sum
};

class Problem {
  public:
    Problem(const Model& model, const Motion& motion, std::span<const double> torque_nm,
            const FitOptions& options)
        : coordinates(model, options.first_guess), motion_(motion), torque_nm_(torque_nm) {
        for (std::size_t k = 0; k < torque_nm.size(); ++k)
            if (options.use.empty() || options.use[k] != 0) rows_.push_back(k);
        if (rows_.size() <= coordinates.list().size())
            raise<UsageError>("{} samples are too few to fit {} values", rows_.size(),
                              coordinates.list().size());
        terms_are_apart_ = motion.known_nm.empty() && std::ranges::all_of(model.terms, [](const Term& term) {
                               const Effect& effect = *term.effect;
                               return effect.chance || (effect.side == Side::joint && !effect.uses_load);
                           });
    }

    [[nodiscard]] Place at(std::vector<double> point) const {
        const std::vector<double> predicted_nm = predict_nm(coordinates.at(point), motion_);
        VectorXd residual(static_cast<Index>(rows_.size()));
        for (std::size_t r = 0; r < rows_.size(); ++r)
            residual[static_cast<Index>(r)] = torque_nm_[rows_[r]] - predicted_nm[rows_[r]];
        const double squares = dot(residual.data(), residual.data(), rows_.size());
        return {std::move(point), std::move(residual), squares};
    }

    // Change of the prediction with each coordinate: exact for linear ones, central differences for the
    // others.
    [[nodiscard]] MatrixXd slopes(const Place& place, const std::vector<std::size_t>& moving) const {
        MatrixXd columns(place.residual.size(), static_cast<Index>(moving.size()));
        for (std::size_t m = 0; m < moving.size(); ++m) {
            const Coordinate& coordinate = coordinates.list()[moving[m]];
            const double value = place.point[moving[m]];
            double up = std::min(value + coordinate.step, coordinate.upper);
            // At its upper bound a linear value has the slope of a step down.
            if (coordinate.linear && !(up > value)) up = value - coordinate.step;
            const double down =
                coordinate.linear ? value : std::max(value - coordinate.step, coordinate.lower);
            const std::vector<double> above_nm = with(place.point, moving[m], up);
            const std::vector<double> below_nm = with(place.point, moving[m], down);
            for (std::size_t r = 0; r < rows_.size(); ++r)
                columns(static_cast<Index>(r), static_cast<Index>(m)) =
                    (above_nm[rows_[r]] - below_nm[rows_[r]]) / (up - down);
        }
        return columns;
    }

    [[nodiscard]] const std::vector<std::size_t>& rows() const { return rows_; }  ///< samples that count

    Coordinates coordinates;

  private:
    // The torque with coordinate `c` at `value`, up to what does not depend on it.
    [[nodiscard]] std::vector<double> with(std::vector<double> point, std::size_t c, double value) const {
        point[c] = value;
        Model model = coordinates.at(point);
        if (terms_are_apart_) model.terms = {model.terms[coordinates.list()[c].term]};
        return predict_nm(model, motion_);
    }

    const Motion& motion_;
    std::span<const double> torque_nm_;
    std::vector<std::size_t> rows_;
    bool terms_are_apart_ = false;  ///< the torque is a sum of torques that each see the motion alone
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

enum class Moving { linear, all };

// Coordinates that may move: all but those at a bound whose best step leads out of it.
std::vector<std::size_t> free_to_move(const Problem& problem, const Place& place, Moving which) {
    std::vector<std::size_t> moving;
    const auto& list = problem.coordinates.list();
    for (std::size_t c = 0; c < list.size(); ++c) {
        if (which == Moving::linear && !list[c].linear) continue;
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

constexpr double next_to_no_damping = 1e-12;  // of columns of length 1: it decides where they are collinear

std::vector<double> moved(const Problem& problem, std::vector<double> point,
                          const std::vector<std::size_t>& moving, const VectorXd& step) {
    for (std::size_t m = 0; m < moving.size(); ++m) {
        const Coordinate& coordinate = problem.coordinates.list()[moving[m]];
        double& value = point[moving[m]];
        value = std::clamp(value + step[static_cast<Index>(m)], coordinate.lower, coordinate.upper);
    }
    return point;
}

// The place with the linear values that are best there. A bound may cut their step short, so that those
// within their bounds are solved for once more.
Place linear_solved(const Problem& problem, Place place) {
    for (int pass = 0; pass < 2; ++pass) {
        const auto moving = free_to_move(problem, place, Moving::linear);
        if (moving.empty()) break;
        const Factored factored = factor(problem.slopes(place, moving), place.residual);
        Place next =
            problem.at(moved(problem, place.point, moving, damped_step(factored, next_to_no_damping)));
        if (!(next.squares < place.squares)) break;
        place = std::move(next);
        const bool within = std::ranges::all_of(moving, [&](std::size_t c) {
            const Coordinate& coordinate = problem.coordinates.list()[c];
            return place.point[c] > coordinate.lower && place.point[c] < coordinate.upper;
        });
        if (within) break;
    }
    return place;
}

struct Search {
    Place place;
    int iterations = 0;
    bool converged = false;
};

// One step from here: the first of successively shorter ones that lowers the sum of squares. Returns false
// when none does. Linear values are solved for anew where the others come to (variable projection: Golub and
// Pereyra, 1973): of the 54 starts of NIST's problems 53 lead to the certified values with it, 46 without it
// (tests/model/fit_test.cpp).
bool step_down(const Problem& problem, Search& search, const std::vector<std::size_t>& moving,
               double& damping) {
    const Factored factored = factor(problem.slopes(search.place, moving), search.place.residual);
    const double before = search.place.squares;
    for (; damping <= 1e6; damping *= 10.0) {
        Place next = linear_solved(
            problem, problem.at(moved(problem, search.place.point, moving, damped_step(factored, damping))));
        if (!(next.squares < before)) continue;  // not a number neither: a step from collinear slopes
        search.place = std::move(next);
        damping = std::max(damping / 10.0, next_to_no_damping);
        return true;
    }
    return false;
}

void descend(const Problem& problem, Search& search, const FitOptions& options) {
    double damping = next_to_no_damping;
    for (int i = 0; i < options.max_iterations && !search.converged; ++i) {
        const auto moving = free_to_move(problem, search.place, Moving::all);
        ++search.iterations;
        const double before = search.place.squares;
        const bool lower = !moving.empty() && step_down(problem, search, moving, damping);
        search.converged = !lower || before - search.place.squares <= options.settled * before;
    }
}

// Row by row; -1 where a coordinate is not identifiable.
std::vector<double> covariance_at(const Problem& problem, const Search& search, const FitOptions& options) {
    const std::size_t n = problem.coordinates.list().size();
    std::vector<double> covariance(n * n, -1.0);
    if (!options.errors) return covariance;
    const auto moving = free_to_move(problem, search.place, Moving::all);
    if (moving.empty()) return covariance;
    const MatrixXd slopes = problem.slopes(search.place, moving);
    const VectorXd& residual = search.place.residual;
    const std::size_t m = moving.size();
    const auto of_moving = covariance_of({slopes.data(), static_cast<std::size_t>(slopes.size())},
                                         {residual.data(), static_cast<std::size_t>(residual.size())},
                                         problem.rows(), options.error_stretch);
    for (std::size_t a = 0; a < m; ++a) {
        for (std::size_t b = 0; b < m; ++b) covariance[moving[a] * n + moving[b]] = of_moving[a * m + b];
    }
    return covariance;
}

}  // namespace

Fit fit(const Model& model, const Motion& motion, std::span<const double> torque_nm,
        const FitOptions& options) {
    const Problem problem(model, motion, torque_nm, options);
    std::vector<double> start;
    for (const Coordinate& coordinate : problem.coordinates.list()) start.push_back(coordinate.start);
    // Linear values are solved for the first guess of the others before those move.
    Search search{linear_solved(problem, problem.at(std::move(start))), 1, false};
    search.converged = std::ranges::all_of(problem.coordinates.list(), &Coordinate::linear);
    if (!search.converged) descend(problem, search, options);
    Fit found;
    found.model = problem.coordinates.at(search.place.point);
    for (std::size_t i = 0; i < model.terms.size(); ++i) {
        if (model.terms[i].effect->chance) found.model.terms[i] = model.terms[i];
    }
    found.samples = problem.rows().size();
    found.values = problem.coordinates.values(search.place.point, covariance_at(problem, search, options));
    found.residual_rms_nm = std::sqrt(search.place.squares / static_cast<double>(found.samples));
    found.iterations = search.iterations;
    found.converged = search.converged;
    return found;
}

}  // namespace ripplenotch
