// SPDX-License-Identifier: MIT
#include "diagnose/engine/search.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>

#include "core/matrices/least_squares.hpp"
#include "core/vectors/dot.hpp"
#include "diagnose/engine/criterion.hpp"
#include "diagnose/engine/gram.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch::engine {
namespace {

using Eigen::Index, Eigen::MatrixXd, Eigen::VectorXd;

// Of the model, as standard errors in addition to those of the noise: frictions of integrated joints build up
// otherwise than Dahl's by so much of their values, and their delays are off by this share of a sample
// (numbers 41 and 902 of scripts/prove-diagnose --physics).
constexpr double loop_form_error = 0.02, sampling_error = 0.04;
constexpr int most_polishes = 4;
constexpr double least_polish = 0.1;  // in squares of the noise: a third of a standard error

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
    // By which the searched values are off their best, to first order; the linear ones follow.
    [[nodiscard]] double searched_step(std::size_t term, std::size_t value) const {
        return step_[static_cast<Index>(searched_place(term, value))];
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
    std::vector<std::array<std::size_t, most_searched>> searched_places_;
    VectorXd step_;
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
            if (sorted[t].kind->searched[v].is_choice) continue;
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
    std::vector<double> left = prediction(criterion, sorted);
    for (double& value : left) value = -value;
    std::vector<std::span<const double>> all = {left};
    for (const int place : design_.columns) all.push_back(criterion.white().column(place));
    for (const auto& slope : slopes) all.emplace_back(slope);
    const auto size = static_cast<Index>(all.size() - 1);
    VectorXd prior = VectorXd::Zero(size);
    for (std::size_t c = 0; c < design_.columns.size(); ++c)
        prior[static_cast<Index>(c)] = 1.0 / (design_.deviation[c] * design_.deviation[c]);
    const VectorXd of_priors = -prior.head(factors_.size()).cwiseProduct(factors_);
    // Products of all columns with what is left and with each other, by stretch.
    const std::size_t stretches = std::min(blocks.count(), most_stretches);
    std::vector<MatrixXd> products(stretches);
    MatrixXd whole = MatrixXd::Zero(size + 1, size + 1);
    for (std::size_t s = 0; s < stretches; ++s) {
        const std::size_t from = blocks.first[s * blocks.count() / stretches];
        const std::size_t length = blocks.first[(s + 1) * blocks.count() / stretches] - from;
        std::vector<std::span<const double>> part;
        for (const auto& column : all) part.push_back(column.subspan(from, length));
        extend_gram(products[s], part, std::vector<unsigned char>(length, 1));
        whole += products[s];
    }
    // The ridge is that of the whole log: a column that acts in one stretch alone is 0 without it.
    const auto solved = [&](MatrixXd gram) {
        gram.col(0).segment(1, of_priors.size()) += of_priors;
        gram.diagonal().tail(size) += prior + ridge * whole.diagonal().tail(size);
        return solve_normal_equations(gram);
    };
    step_ = solved(whole);
    // Jackknife: each stretch left out in turn.
    MatrixXd moved(size, static_cast<Index>(stretches));
    for (std::size_t s = 0; s < stretches; ++s)
        moved.col(static_cast<Index>(s)) = solved(whole - products[s]);
    const VectorXd mean = moved.rowwise().mean();
    for (Index s = 0; s < moved.cols(); ++s) moved.col(s) -= mean;
    covariance_ = (1.0 - 1.0 / static_cast<double>(stretches)) * moved * moved.transpose();
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
    const double quantile =
        student_95(static_cast<double>(std::min(criterion.blocks().count(), most_stretches)) - 1.0);
    std::vector<ValuedTerm> found;
    for (const SearchedTerm& term : terms) {
        const auto t = static_cast<std::size_t>(std::ranges::find(sorted, term) - sorted.begin());
        const Effect& effect = *term.kind->effect;
        const std::vector<double> unit = unit_values(term);
        ValuedTerm valued{{&effect, {unit.begin(), unit.end()}}, {}};
        std::vector<Derived> values =
            linear_values(term, fit, fit.design().first_of_term[t], base.columns.size(), base.orders.size());
        for (std::size_t v = 0; v < term.kind->searched.size(); ++v) {
            if (term.kind->searched[v].is_choice) {
                valued.term.values[term.kind->searched[v].parameter] = term.values[v];
                continue;
            }
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
            double error = std::sqrt(std::max(fit.variance(derived), 0.0));
            if (term.is("hysteresis")) error = portable::hypot(error, loop_form_error * derived.value);
            if (term.kind->role == Role::sensor && effect.parameters[derived.parameter].unit == "s")
                error = portable::hypot(error, sampling_error * criterion.recorded().step_s());
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

namespace {

// Student's t of nineteen degrees of freedom at 0.05 / 70: the best is taken of five other joints at fourteen
// ratios each. At 0.05 a shoulder and an elbow that share nothing had a ratio of 0.42 +/- 0.41.
constexpr double shared_ratio_errors = 4.0;

}  // namespace

bool may_be_absent(const ValuedTerm& valued) {
    const std::vector<Parameter>& parameters = valued.term.effect->parameters;
    const bool has_factor = std::ranges::any_of(parameters, &Parameter::linear);
    // Where the other joint's share may be none, nothing is shared.
    if (valued.term.effect->other_joint && std::ranges::any_of(valued.values, [&](const FittedValue& value) {
            return parameters[value.parameter].name == "ratio" &&
                   std::abs(value.value) < shared_ratio_errors * value.standard_error.value_or(0.0);
        }))
        return true;
    return std::ranges::all_of(valued.values, [&](const FittedValue& value) {
        const Parameter& parameter = parameters[value.parameter];
        if (has_factor ? !parameter.linear : &value != &valued.values.front()) return true;
        return value.ci95 && value.ci95->low <= parameter.neutral && parameter.neutral <= value.ci95->high;
    });
}

SearchedTerms polished(Criterion& criterion, const SearchedTerms& terms) {
    SearchedTerms best = terms;
    for (int turn = 0; turn < most_polishes; ++turn) {
        SearchedTerms sorted = best;
        std::sort(sorted.begin(), sorted.end());
        const Linearised fit(criterion, sorted);
        SearchedTerms next = best;
        for (SearchedTerm& term : next) {
            const auto t = static_cast<std::size_t>(std::ranges::find(sorted, term) - sorted.begin());
            for (std::size_t v = 0; v < term.kind->searched.size() && term.kind->is_refined; ++v) {
                const SearchedValue& bounds = term.kind->searched[v];
                if (bounds.is_choice || std::abs(term.values[v]) == bounds.plain) continue;
                const double value = term.values[v] + fit.searched_step(t, v);
                const double upper = bounds.upper * width_scale(*term.kind, bounds, criterion.recorded());
                const bool is_within = bounds.lower < std::abs(value) && std::abs(value) < upper;
                if (is_within || term.kind->role == Role::motor_angle) term.values[v] = value;
            }
        }
        const double gain = criterion.fit(best).squares - criterion.fit(next).squares;
        if (gain > 0.0) best = next;
        if (gain < least_polish) break;
    }
    return best;
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
