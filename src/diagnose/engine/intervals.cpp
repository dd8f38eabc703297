// SPDX-License-Identifier: MIT
#include "diagnose/engine/intervals.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>

#include "core/matrices/factorisations.hpp"
#include "core/matrices/least_squares.hpp"
#include "core/vectors/dot.hpp"
#include "diagnose/engine/gram.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch::engine {
namespace {

using Eigen::Index, Eigen::MatrixXd, Eigen::VectorXd;

// A number that is a function of the fitted ones, linearised.
struct Derived {
    std::size_t parameter = 0;
    double value = 0.0;
    std::vector<std::pair<std::size_t, double>> slopes;  // place of a fitted number, derivative
};

class Linearised {
  public:
    Linearised(Criterion& criterion, const SearchedTerms& sorted);

    [[nodiscard]] const Design& design() const { return design_; }
    [[nodiscard]] double factor(std::size_t column) const { return factors_[static_cast<Index>(column)]; }
    // Place of a searched value of a term among the fitted numbers.
    [[nodiscard]] std::size_t searched_place(std::size_t term, std::size_t value) const {
        return searched_places_[term][value];
    }
    [[nodiscard]] double variance(const Derived& derived) const {
        double sum = 0.0;
        for (const auto& [a, slope_a] : derived.slopes)
            for (const auto& [b, slope_b] : derived.slopes)
                sum += slope_a * slope_b * covariance_(static_cast<Index>(a), static_cast<Index>(b));
        return sum;
    }

  private:
    std::vector<double> prediction(Criterion& criterion, const SearchedTerms& terms) const;

    Design design_;
    VectorXd factors_;
    std::vector<std::array<std::size_t, 2>> searched_places_;
    MatrixXd covariance_;
};

// Fitted torque less the target, whitened.
std::vector<double> Linearised::prediction(Criterion& criterion, const SearchedTerms& terms) const {
    const Design made = criterion.design(terms);
    const auto target = criterion.white().column(made.target);
    std::vector<double> sum(target.begin(), target.end());
    for (double& value : sum) value = -value;
    for (std::size_t c = 0; c < made.columns.size(); ++c)
        add_scaled(factor(c), criterion.white().column(made.columns[c]).data(), sum.data(), sum.size());
    return sum;
}

Linearised::Linearised(Criterion& criterion, const SearchedTerms& sorted)
    : design_(criterion.design(sorted)), factors_(criterion.fit(sorted).factors) {
    const Blocks& blocks = criterion.blocks();
    std::vector<std::vector<double>> slopes;  // by the searched values
    searched_places_.resize(sorted.size());
    for (std::size_t t = 0; t < sorted.size(); ++t) {
        for (std::size_t v = 0; v < sorted[t].kind->searched.size(); ++v) {
            searched_places_[t][v] = design_.columns.size() + slopes.size();
            const double step = 1e-3 * std::max(std::abs(sorted[t].values[v]), 1e-3);
            SearchedTerms less = sorted, more = sorted;
            less[t].values[v] -= step;
            more[t].values[v] += step;
            std::vector<double> slope = prediction(criterion, more);
            const std::vector<double> low = prediction(criterion, less);
            for (std::size_t k = 0; k < slope.size(); ++k) slope[k] = (slope[k] - low[k]) / (2.0 * step);
            slopes.push_back(std::move(slope));
        }
    }
    std::vector<double> residual = prediction(criterion, sorted);
    std::vector<std::span<const double>> all;
    for (const int place : design_.columns) all.push_back(criterion.white().column(place));
    for (const auto& slope : slopes) all.emplace_back(slope);
    const auto size = static_cast<Index>(all.size());
    MatrixXd bread = MatrixXd::Zero(size, size), meat = bread;
    for (Index i = 0; i < size; ++i) {
        const auto& x = all[static_cast<std::size_t>(i)];
        for (Index j = 0; j <= i; ++j)
            bread(i, j) = bread(j, i) = dot(x.data(), all[static_cast<std::size_t>(j)].data(), x.size());
    }
    VectorXd scale = bread.diagonal().cwiseMax(1e-300).cwiseSqrt();
    for (std::size_t c = 0; c < design_.columns.size(); ++c) {
        const double deviation = design_.deviation[c];
        const auto i = static_cast<Index>(c);
        if (deviation < std::numeric_limits<double>::infinity()) bread(i, i) += 1.0 / (deviation * deviation);
    }
    for (std::size_t block = 0; block < blocks.count(); ++block) {
        const std::size_t from = blocks.first[block], length = blocks.first[block + 1] - from;
        VectorXd score(size);
        for (Index i = 0; i < size; ++i)
            score[i] = dot(&all[static_cast<std::size_t>(i)][from], &residual[from], length) / scale[i];
        meat += score * score.transpose();
    }
    const double count = static_cast<double>(blocks.count());
    meat *= count / std::max(count - 1.0, 1.0);
    for (Index i = 0; i < size; ++i)
        for (Index j = 0; j < size; ++j) bread(i, j) /= scale[i] * scale[j];
    bread.diagonal().array() += ridge;
    const MatrixXd inverse = SymmetricFactors(bread).solve(MatrixXd(MatrixXd::Identity(size, size)));
    covariance_ = inverse * meat * inverse;
    for (Index i = 0; i < size; ++i)
        for (Index j = 0; j < size; ++j) covariance_(i, j) /= scale[i] * scale[j];
}

// Size and phase of x cos(angle) + y sin(angle), in the catalogue's cos(angle + phase).
std::vector<Derived> polar_values(const Polar& polar, std::size_t place, double x, double y, double unit) {
    const double size = std::max(portable::hypot(x, y), 1e-300);
    return {{polar.size, unit * size, {{place, unit * x / size}, {place + 1, unit * y / size}}},
            {polar.phase,
             portable::atan2(-y, x) * degrees_per_radian,
             {{place, degrees_per_radian * y / (size * size)},
              {place + 1, -degrees_per_radian * x / (size * size)}}}};
}

// A change of the ripple as a share of the ripple itself, the mean over the orders by their squares; the part
// across is a turn of its phase.
std::vector<Derived> ripple_change_values(const TermKind& kind, const Linearised& fit, std::size_t place,
                                          std::size_t first_ripple, std::size_t orders) {
    std::complex<double> product = 0.0;
    double squares = 0.0;
    std::vector<std::complex<double>> ripple;
    for (std::size_t order = 0; order < orders; ++order) {
        const auto wave = [&](std::size_t first) {
            return std::complex<double>(fit.factor(first + 2 * order), -fit.factor(first + 2 * order + 1));
        };
        ripple.push_back(wave(first_ripple));
        product += std::conj(ripple.back()) * wave(place);
        squares += std::norm(ripple.back());
    }
    squares = std::max(squares, 1e-300);
    const auto part = [&](std::size_t parameter, double unit, bool is_along) {
        Derived derived{parameter, unit * (is_along ? product.real() : product.imag()) / squares, {}};
        for (std::size_t order = 0; order < orders; ++order) {
            const double x = ripple[order].real(), y = ripple[order].imag();
            derived.slopes.emplace_back(place + 2 * order, unit * (is_along ? x : -y) / squares);
            derived.slopes.emplace_back(place + 2 * order + 1, unit * (is_along ? -y : -x) / squares);
        }
        return derived;
    };
    std::vector<Derived> values = {part(0, 100.0, true)};
    if (const auto phase = find_parameter(*kind.effect, "phase_deg"))
        values.push_back(part(*phase, degrees_per_radian, false));
    return values;
}

std::vector<Derived> linear_values(const SearchedTerm& term, const Linearised& fit, std::size_t place,
                                   std::size_t first_ripple, std::size_t orders) {
    const Effect& effect = *term.kind->effect;
    switch (term.kind->role) {
        case Role::joint_torque:
        case Role::sensor_torque:
        case Role::ripple_change: {
            const double unit = term.changes_ripple() ? 100.0 : 1.0;
            if (effect.polar)
                return polar_values(*effect.polar, place, fit.factor(place), fit.factor(place + 1), unit);
            if (term.changes_ripple())
                return ripple_change_values(*term.kind, fit, place, first_ripple, orders);
            std::vector<Derived> values;
            for (std::size_t p = 0; p < effect.parameters.size(); ++p) {
                if (!effect.parameters[p].linear) continue;
                values.push_back({p, fit.factor(place), {{place, 1.0}}});
                ++place;
            }
            return values;
        }
        case Role::elastic_joint:
        case Role::sensor:
        case Role::motor_angle:
            break;
    }
    return {};
}

}  // namespace

std::vector<ValuedTerm> valued_terms(Criterion& criterion, const SearchedTerms& terms) {
    SearchedTerms sorted = terms;
    std::sort(sorted.begin(), sorted.end());
    const Linearised fit(criterion, sorted);
    const Baseline& base = criterion.base();
    const double quantile = student_95(static_cast<double>(criterion.blocks().count()) - 1.0);
    std::vector<ValuedTerm> found;
    for (const SearchedTerm& term : terms) {
        const auto t = static_cast<std::size_t>(std::ranges::find(sorted, term) - sorted.begin());
        const Effect& effect = *term.kind->effect;
        const std::vector<double> unit = unit_values(term);
        ValuedTerm valued{{&effect, {unit.begin(), unit.end()}}, {}};
        std::vector<Derived> values =
            linear_values(term, fit, fit.design().first_of_term[t], base.columns.size(), base.orders.size());
        for (std::size_t v = 0; v < term.kind->searched.size(); ++v) {
            Derived searched{
                term.kind->searched[v].parameter, term.values[v], {{fit.searched_place(t, v), 1.0}}};
            if (term.is("gear-ratio")) {
                const double percent = 100.0 / base.ratio.value();
                searched.value = percent * term.values[v] - 100.0;
                searched.slopes[0].second = percent;
            }
            values.push_back(searched);
        }
        for (const Derived& derived : values) {
            const double error = std::sqrt(std::max(fit.variance(derived), 0.0));
            valued.term.values[derived.parameter] = derived.value;
            valued.values.push_back(
                {.term = found.size(),
                 .parameter = derived.parameter,
                 .value = derived.value,
                 .standard_error = error,
                 .ci95 = Interval{derived.value - quantile * error, derived.value + quantile * error}});
        }
        found.push_back(std::move(valued));
    }
    return found;
}

std::vector<ValuedColumn> valued_columns(Criterion& criterion, const SearchedTerms& terms) {
    SearchedTerms sorted = terms;
    std::sort(sorted.begin(), sorted.end());
    const Linearised fit(criterion, sorted);
    std::vector<ValuedColumn> found;
    for (std::size_t c = 0; c < criterion.base().columns.size(); ++c) {
        const Derived factor{0, fit.factor(c), {{c, 1.0}}};
        found.push_back(
            {criterion.base().columns[c].name, factor.value, std::sqrt(std::max(fit.variance(factor), 0.0))});
    }
    return found;
}

}  // namespace ripplenotch::engine
