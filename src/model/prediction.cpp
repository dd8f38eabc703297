// SPDX-License-Identifier: MIT
#include "model/prediction.hpp"

#include <algorithm>

#include "ripplenotch/model/prediction.hpp"

namespace ripplenotch {

Prediction::Prediction(Model model, const Motion& motion, Carriers* carriers)
    : state_(std::make_unique<State>(std::move(model), motion, carriers)) {}

Prediction::Prediction(std::unique_ptr<State> state) : state_(std::move(state)) {}

Prediction::~Prediction() = default;

Prediction::Prediction(Prediction&&) noexcept = default;

Prediction& Prediction::operator=(Prediction&&) noexcept = default;

const Model& Prediction::model() const { return state_->model; }

const std::vector<double>& Prediction::torque_nm() const { return state_->torque_nm; }

std::size_t Prediction::applied() const { return state_->applied; }

Prediction Prediction::with(const Term& term) const {
    Model model = state_->model;
    model.terms.push_back(term);
    if (const auto ratio = state_->ratio_of_ripple(term))
        return Prediction(std::make_unique<State>(*state_, std::move(model), *ratio));
    return Prediction(std::move(model), state_->logged, state_->carriers);
}

bool Prediction::has_only_ripple_anew() const { return state_->is_ripple_anew; }

std::optional<std::vector<double>> Prediction::behind(const Term& sensor,
                                                      std::vector<double> torque_nm) const {
    const Effect& effect = *sensor.effect;
    const bool last = std::ranges::none_of(state_->model.terms, [](const Term& term) {
        return term.effect->side == Side::converter && !term.effect->chance;
    });
    if (side_of(sensor) != Side::sensor || !effect.linear_in_torque || effect.uses_load || !last)
        return std::nullopt;
    effect.apply(state_->situation(state_->load), values_of(sensor), torque_nm);
    return torque_nm;
}

std::vector<double> Prediction::added(const Term& term) const {
    Model with = state_->model;
    with.terms.push_back(term);
    return state_->difference_to(with, with.terms.size() - 1);
}

std::vector<double> Prediction::changed(std::size_t place, const Term& term) const {
    Model other = state_->model;
    other.terms.at(place) = term;
    return state_->difference_to(other, place);
}

}  // namespace ripplenotch
