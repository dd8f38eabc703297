// SPDX-License-Identifier: MIT
#include "diagnose/search/model_bench.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "core/rows/row_facts.hpp"
#include "core/vectors/dot.hpp"
#include "diagnose/case/known_torque.hpp"
#include "diagnose/limits.hpp"
#include "diagnose/search/search_starts.hpp"
#include "ripplenotch/model/prediction.hpp"

namespace ripplenotch {

namespace {

void take_off(std::span<const Column> basis, Column& column) {
    for (const Column& other : basis)
        add_scaled(-product(other, column), other.data(), column.data(), column.size());
}

double length_of_column(const Column& column) { return std::sqrt(product(column, column)); }

// A row for each column of `a`, with its products with each of `b`; two by two.
std::vector<Column> products(std::span<const Column> a, std::span<const Column* const> b) {
    std::vector<Column> all(a.size(), Column(b.size()));
    for (std::size_t i = 0; i < a.size(); i += 2) {
        const std::size_t next_i = i + 1 < a.size() ? i + 1 : i;
        for (std::size_t j = 0; j < b.size(); j += 2) {
            const std::size_t next_j = j + 1 < b.size() ? j + 1 : j;
            double sums[4] = {};
            add_dots({a[i].data(), a[next_i].data()}, {b[j]->data(), b[next_j]->data()}, a[i].size(), sums);
            all[i][j] = sums[0];
            all[i][next_j] = sums[next_j - j];
            all[next_i][j] = sums[2 * (next_i - i)];
            all[next_i][next_j] = sums[2 * (next_i - i) + (next_j - j)];
        }
    }
    return all;
}

}  // namespace

double product(const Column& a, const Column& b) { return dot(a.data(), b.data(), a.size()); }

// A column that keeps most of its length is orthogonal to rounding after one pass; twice is enough for any
// other (Kahan, Parlett).
std::vector<Column> orthonormal(std::span<const Column> columns) {
    std::vector<Column> basis;
    for (const Column& given : columns) {
        const double length = length_of_column(given);
        if (!(length > 0.0)) continue;
        Column column = given;
        take_off(basis, column);
        if (length_of_column(column) < 0.5 * length) take_off(basis, column);
        const double left = length_of_column(column);
        if (!(left > 1e-7 * length)) continue;
        for (double& value : column) value /= left;
        basis.push_back(std::move(column));
    }
    return basis;
}

Column outside_of(std::span<const Column> basis, Column column) {
    take_off(basis, column);
    return column;
}

double explained(std::span<const Column> basis, std::span<const Column> columns, const Column& left) {
    constexpr double least_square = 1e-10;
    const std::size_t count = columns.size();
    std::vector<const Column*> with_left;
    for (const Column& column : columns) with_left.push_back(&column);
    with_left.push_back(&left);
    const std::vector<Column> along = products(basis, with_left), among = products(columns, with_left);
    // Rows of a triangle whose square is the products of what lies outside the basis (Cholesky); its last
    // column is what each new direction explains.
    std::vector<Column> triangle(count, Column(count + 1, 0.0));
    double sum = 0.0;
    for (const Column& row : along) sum += row[count] * row[count];
    for (std::size_t c = 0; c < count; ++c) {
        const auto outside = [&](std::size_t d) {
            double value = among[c][d];
            for (const Column& row : along) value -= row[c] * row[d];
            for (std::size_t before = 0; before < c; ++before)
                value -= triangle[before][c] * triangle[before][d];
            return value;
        };
        const double square = outside(c);
        if (!(square > least_square * among[c][c])) continue;
        triangle[c][c] = std::sqrt(square);
        for (std::size_t d = c + 1; d <= count; ++d) triangle[c][d] = outside(d) / triangle[c][c];
        sum += triangle[c][count] * triangle[c][count];
    }
    return sum;
}

double material_sigma(const Case& looked_at) {
    return looked_at.step_nm > 0.0 ? limits::judge::material_sigma_of_steps : limits::judge::material_sigma;
}

double Candidate::criterion() const { return gain_left + std::accumulate(prices.begin(), prices.end(), 0.0); }

namespace {

std::vector<Term> sensors_of(const Model& model) {
    std::vector<Term> sensors;
    for (const Term& term : model.terms) {
        if (side_of(term) == Side::sensor) sensors.push_back(term);
    }
    return sensors;
}

// Errors of the motion that pass them are as good as the same.
bool is_as_good(const std::vector<Term>& sensors, const std::vector<Term>& others) {
    constexpr double part = 0.01;  // chosen, not derived
    return std::ranges::equal(sensors, others, [](const Term& one, const Term& other) {
        return one.effect == other.effect && std::ranges::equal(one.values, other.values, [](auto a, auto b) {
                   return a == b || (a && b && std::abs(*a - *b) <= part * std::abs(*b));
               });
    });
}

}  // namespace

ModelBench::ModelBench(const Case& looked_at, const NoiseFloor& noise, Work& work,
                       std::shared_ptr<KeptScreenings> kept)
    : case_(looked_at),
      noise_(noise),
      work_(work),
      weighing_(looked_at.size(), looked_at.use, noise.color, looked_at.valid),
      kept_(std::move(kept)) {
    if (!(noise_.material_nm > 0.0)) noise_.material_nm = noise_.rms_nm;
}

double ModelBench::same_model_nm2() const {
    return limits::screening::same_model * noise_.rms_nm * noise_.rms_nm;
}

void ModelBench::settle_on(const Model& model) {
    // The random-walk error of the angle is weighted against the whole residual of the model: against the
    // sensor's noise alone, an implausible walk would replace missing terms of the model, and inflate the
    // ripple to do so.
    if (!case_.uncertain.empty() && !known_)
        known_ = std::make_shared<KnownFit>(case_, model, weighing_, noise_.white_nm);
    const std::vector<double> white = weighing_.whitened(raw_residual(model));
    const double left_nm = rms(std::span(white).first(weighing_.rows().size()));
    walks_ = walk_errors(case_, model);
    walks_beside_nm_ = std::max(noise_.white_nm, left_nm);
    sensors_ = sensors_of(model);
    is_settled_ = true;
    if (!case_.uncertain.empty())
        known_ = std::make_shared<KnownFit>(case_, model, weighing_, noise_.white_nm);
    weighing_.set_nuisance(errors_of(model), walks_beside_nm_);
}

std::vector<Nuisance> ModelBench::errors_of(const Model& model) const {
    std::vector<Nuisance> errors = acceleration_errors(case_, model);
    for (Nuisance& column : uncertain_torques(case_, model)) errors.push_back(std::move(column));
    errors.insert(errors.end(), walks_.begin(), walks_.end());
    return errors;
}

// Errors of the motion pass through the sensors of a model: a resonance excited by accelerations that
// smoothing removed must not be tested with errors that do not pass through it.
ModelBench::OwnWeighing ModelBench::weighing_of(const Model& model) const {
    OwnWeighing own;
    own.beside = sensors_of(model);
    if (!is_settled_ || is_as_good(own.beside, sensors_)) return own;
    own.other.emplace(weighing_);
    own.other->set_nuisance(errors_of(model), walks_beside_nm_);
    return own;
}

Candidate ModelBench::fitted(const Model& open, const Model& first_guess, std::vector<double> prices,
                             int most_iterations, double settled) const {
    OwnWeighing own = weighing_of(first_guess);
    const auto from = [&](const Model& guess, int iterations, double until) {
        return fitted(open, prices,
                      {.first_guess = &guess,
                       .most_iterations = iterations,
                       .settled = until,
                       .errors = false,
                       .weighing = own.other ? &*own.other : &weighing_,
                       .carriers = &carriers_});
    };
    // Errors that pass a sensor with outdated values can replace the torque itself: the last fit takes them
    // through the current one. Before, the sensor's values are known only roughly.
    constexpr double roughly = 1e-3;  // chosen, not derived: as the steps of each search
    bool is_rough = own.other.has_value();
    Candidate found = from(first_guess, most_iterations, is_rough ? std::max(settled, roughly) : settled);
    for (const int iterations : {std::min(most_iterations, 6), 2, 0}) {
        if (!is_rough && is_as_good(sensors_of(found.stated), own.beside)) break;
        is_rough = false;
        own = weighing_of(found.stated);
        const Model guess = found.stated;
        found = from(guess, iterations, settled);
    }
    state_where_told(found, case_);
    return found;
}

std::vector<double> ModelBench::torque_of(const Model& stated, std::size_t term) const {
    Model others = stated;
    others.terms.erase(others.terms.begin() + static_cast<std::ptrdiff_t>(term));
    return Prediction(others, case_.motion).added(stated.terms[term]);
}

Candidate ModelBench::with_errors(Candidate model) const {
    const Fit there = fit(
        model.open, case_.motion, case_.torque_nm,
        {.first_guess = &model.stated, .most_iterations = 0, .weighing = &weighing_, .carriers = &carriers_});
    work_.add(there.applied, case_.size());
    model.values = there.values;
    return model;
}

Candidate ModelBench::settled(const Candidate& model) const {
    return fitted(model.open, model.prices,
                  {.first_guess = &model.stated,
                   .most_iterations = 30,
                   .error_stretch = static_cast<std::size_t>(
                       std::ceil(limits::values::error_stretch_s * case_.motion.sample_rate.value())),
                   .weighing = &weighing_,
                   .carriers = &carriers_});
}

Candidate ModelBench::fitted(const Model& open, std::vector<double> prices, const FitOptions& options) const {
    const Fit found = fit(open, case_.motion, case_.torque_nm, options);
    work_.add(found.applied, case_.size());
    const double squares = found.residual_rms_nm * found.residual_rms_nm * static_cast<double>(found.samples);
    return {open,
            found.model,
            found.values,
            std::move(prices),
            squares / (noise_.white_nm * noise_.white_nm),
            found.converged};
}

double ModelBench::share(const Candidate& with, const Candidate& without) const {
    const auto left_with = raw_residual(with.stated), left_without = raw_residual(without.stated);
    double raw = 0.0, moved = 0.0;
    for (const std::size_t k : rows()) {
        raw += (left_without[k] * left_without[k] - left_with[k] * left_with[k]) / samples();
        moved += (left_without[k] - left_with[k]) * (left_without[k] - left_with[k]) / samples();
    }
    // With coloured noise the whitened gain is the sharper measure, for a slow effect the torque itself;
    // nothing explains more than its own torque.
    const double white = (without.gain_left - with.gain_left) / samples() * noise_.white_nm * noise_.white_nm;
    return std::sqrt(std::max({std::min(white, moved), raw, 0.0})) / noise_.material_nm;
}

std::vector<double> ModelBench::cleared_residual(const Model& stated) const {
    Weighing plain(case_.size(), case_.use, {});
    plain.set_nuisance(motion_errors(case_, stated), noise_.rms_nm);
    const auto cleared = plain(raw_residual(stated));
    // Weighing leaves out what noise_.color makes unusable as well; here only rows() are returned.
    std::vector<double> all(case_.size(), 0.0), told;
    for (std::size_t r = 0; r < plain.rows().size(); ++r) all[plain.rows()[r]] = cleared[r];
    for (const std::size_t k : rows()) told.push_back(all[k]);
    return told;
}

double ModelBench::floor_nm(const Model& stated) const {
    const auto left = raw_residual(stated), cleared = cleared_residual(stated);
    double all = 0.0, beside = 0.0;
    for (std::size_t r = 0; r < rows().size(); ++r) {
        all += left[rows()[r]] * left[rows()[r]];
        beside += cleared[r] * cleared[r];
    }
    return std::sqrt(noise_.rms_nm * noise_.rms_nm + std::max(all - beside, 0.0) / samples());
}

std::vector<double> ModelBench::raw_residual(const Model& stated) const {
    std::vector<double> left = predict_nm(stated, case_.motion);
    for (std::size_t k = 0; k < left.size(); ++k) left[k] = case_.torque_nm[k] - left[k];
    return known_ ? known_->residual(weighing_, std::move(left)) : left;
}

std::vector<double> ModelBench::whitened(std::span<const double> torque_nm) const {
    std::vector<double> white = weighing_.whitened(torque_nm);
    white.resize(weighing_.rows().size());
    for (double& value : white) value /= noise_.white_nm;
    return white;
}

std::vector<double> ModelBench::residual(const Model& stated) const {
    const OwnWeighing own = weighing_of(stated);
    std::vector<double> left = (own.other ? *own.other : weighing_)(raw_residual(stated));
    left.resize(weighing_.rows().size());
    for (double& value : left) value /= noise_.white_nm;
    return left;
}

}  // namespace ripplenotch
