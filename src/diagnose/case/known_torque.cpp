// SPDX-License-Identifier: MIT
#include "diagnose/case/known_torque.hpp"

#include <algorithm>
#include <cmath>

#include "core/matrices/least_squares.hpp"
#include "core/vectors/dot.hpp"

namespace ripplenotch {

using Eigen::Index;

Ridge::Ridge(const std::vector<std::vector<double>>& columns, std::span<const double> deviation, double noise)
    : columns_(columns), noise_(noise) {
    // Collinear columns share their contribution in place of a division by zero.
    constexpr double least_of_its_own = 1e-9;
    Eigen::MatrixXd products(static_cast<Index>(columns.size()), static_cast<Index>(columns.size()));
    for (std::size_t r = 0; r < columns.size(); ++r) {
        for (std::size_t c = 0; c <= r; ++c) {
            const double product = dot(columns[r].data(), columns[c].data(), columns[r].size());
            products(static_cast<Index>(r), static_cast<Index>(c)) = product;
            products(static_cast<Index>(c), static_cast<Index>(r)) = product;
        }
        const double prior = noise / deviation[r];
        products(static_cast<Index>(r), static_cast<Index>(r)) += prior * prior;
    }
    factored_ = ScaledDefiniteFactors(std::move(products), least_of_its_own);
}

std::vector<double> Ridge::solve(std::span<const double> target) const {
    Eigen::VectorXd products(static_cast<Index>(columns_.size()));
    for (std::size_t r = 0; r < columns_.size(); ++r)
        products[static_cast<Index>(r)] = dot(columns_[r].data(), target.data(), target.size());
    const Eigen::VectorXd values = factored_.solve(products);
    return {values.begin(), values.end()};
}

std::vector<double> Ridge::standard_errors() const {
    const Eigen::VectorXd errors = noise_ * factored_.inverse_diagonal().cwiseSqrt();
    return {errors.begin(), errors.end()};
}

double rms_of(const std::vector<double>& values, const std::vector<unsigned char>& use) {
    double sum = 0.0, count = 0.0;
    for (std::size_t k = 0; k < values.size(); ++k) {
        if (use[k] == 0) continue;
        sum += values[k] * values[k];
        count += 1.0;
    }
    return std::sqrt(sum / std::max(count, 1.0));
}

std::vector<double> residual_nm(const Case& looked_at, const Model& stated) {
    std::vector<double> left = predict_nm(stated, looked_at.motion);
    for (std::size_t k = 0; k < left.size(); ++k) left[k] = looked_at.torque_nm[k] - left[k];
    return left;
}

double left_rms(const Case& looked_at, const Model& stated) {
    return rms_of(residual_nm(looked_at, stated), looked_at.use);
}

namespace {

constexpr std::string_view simulation_name = "simulated";

bool is_uncertain(const GivenTerm& term, std::size_t value) {
    return term.deviation[value] > stated_deviation && term.name != simulation_name;
}

}  // namespace

void take_known_torque(Case& whole, std::span<const GivenTerm> given) {
    if (given.empty()) return;
    whole.motion.known_nm.assign(whole.size(), 0.0);
    for (const GivenTerm& term : given) {
        for (std::size_t i = 0; i < term.torque_nm.size(); ++i) {
            add_scaled(term.mean[i], term.torque_nm[i].data(), whole.motion.known_nm.data(), whole.size());
            if (is_uncertain(term, i)) whole.uncertain.push_back({term.torque_nm[i], term.deviation[i]});
        }
    }
}

namespace {

std::vector<std::vector<double>> torque_columns(const std::vector<Nuisance>& columns) {
    std::vector<std::vector<double>> torques;
    for (const Nuisance& column : columns) torques.push_back(column.torque_nm);
    return torques;
}

// A number a row that counts, whatever nuisance parameters the weighing has.
std::vector<double> white_rows(const Weighing& weighing, const std::vector<double>& torque_nm) {
    std::vector<double> white = weighing.whitened(torque_nm);
    white.resize(weighing.rows().size());
    return white;
}

std::vector<std::vector<double>> whitened(const std::vector<std::vector<double>>& columns,
                                          const Weighing& weighing) {
    std::vector<std::vector<double>> white;
    for (const auto& column : columns) white.push_back(white_rows(weighing, column));
    return white;
}

std::vector<double> deviations_of(const std::vector<Nuisance>& columns) {
    std::vector<double> deviations;
    for (const Nuisance& column : columns) deviations.push_back(column.usual_size);
    return deviations;
}

}  // namespace

KnownFit::KnownFit(const Case& looked_at, const Model& model, const Weighing& weighing, double white_nm)
    : sensed_nm_(torque_columns(uncertain_torques(looked_at, model))),
      white_(whitened(sensed_nm_, weighing)),
      fit_(white_, deviations_of(looked_at.uncertain), white_nm) {}

KnownValues KnownFit::values(const Weighing& weighing, const std::vector<double>& left_nm) const {
    return {fit_.solve(white_rows(weighing, left_nm)), fit_.standard_errors()};
}

std::vector<double> KnownFit::residual(const Weighing& weighing, std::vector<double> left_nm) const {
    const std::vector<double> values = fit_.solve(white_rows(weighing, left_nm));
    for (std::size_t i = 0; i < values.size(); ++i)
        add_scaled(-values[i], sensed_nm_[i].data(), left_nm.data(), left_nm.size());
    return left_nm;
}

KnownValues fit_known_values(const Case& looked_at, const Model& stated, const NoiseFloor& noise) {
    if (looked_at.uncertain.empty()) return {};
    const Weighing weighing(looked_at.size(), looked_at.use, noise.color, looked_at.valid);
    std::vector<double> left = predict_nm(stated, looked_at.motion);
    for (std::size_t k = 0; k < left.size(); ++k) left[k] = looked_at.torque_nm[k] - left[k];
    return KnownFit(looked_at, stated, weighing, noise.white_nm).values(weighing, left);
}

Case with_known_values(Case looked_at, const KnownValues& values) {
    for (std::size_t i = 0; i < values.departure.size(); ++i)
        add_scaled(values.departure[i], looked_at.uncertain[i].torque_nm.data(),
                   looked_at.motion.known_nm.data(), looked_at.size());
    return looked_at;
}

std::vector<GivenValue> reported_values(std::span<const GivenTerm> given, const KnownValues& values) {
    std::vector<GivenValue> reported;
    std::size_t next = 0;
    for (const GivenTerm& term : given) {
        for (std::size_t i = 0; i < term.mean.size(); ++i) {
            GivenValue value{term.name, term.mean[i], std::nullopt};
            if (is_uncertain(term, i)) {
                value.value += values.departure[next];
                const double half = normal_95_errors * values.standard_error[next++];
                value.ci95 = Interval{value.value - half, value.value + half};
            }
            reported.push_back(std::move(value));
        }
    }
    return reported;
}

}  // namespace ripplenotch
