// SPDX-License-Identifier: MIT
#include "diagnose/known_torque.hpp"

#include "core/matrices/normal_errors.hpp"
#include "core/vectors/dot.hpp"
#include "diagnose/ridge.hpp"

namespace ripplenotch {
namespace {

constexpr std::string_view simulated = "simulated";

bool is_uncertain(const GivenTerm& term, std::size_t value) {
    return term.deviation[value] > stated_deviation && term.name != simulated;
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

KnownValues fit_known_values(const Case& looked_at, const Model& stated, const NoiseFloor& noise) {
    const std::vector<Nuisance> columns = uncertain_torques(looked_at, stated);
    KnownValues values;
    if (columns.empty()) return values;
    const Weighing weighing(looked_at.size(), looked_at.use, noise.color, looked_at.valid);
    std::vector<double> left = predict_nm(stated, looked_at.motion);
    for (std::size_t k = 0; k < left.size(); ++k) left[k] = looked_at.torque_nm[k] - left[k];
    left = weighing.whitened(left);
    std::vector<std::vector<double>> white;
    std::vector<double> deviation;
    for (const Nuisance& column : columns) {
        white.push_back(weighing.whitened(column.torque_nm));
        deviation.push_back(column.usual_size);
    }
    const Ridge fit(white, deviation, noise.white_nm);
    values.departure = fit.solve(left);
    values.standard_error = fit.standard_errors();
    return values;
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
