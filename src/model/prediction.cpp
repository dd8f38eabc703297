// SPDX-License-Identifier: MIT
#include "ripplenotch/model/prediction.hpp"

#include <algorithm>
#include <complex>
#include <map>
#include <optional>
#include <vector>

#include "core/vectors/dot.hpp"
#include "model/carriers.hpp"
#include "model/model.hpp"

namespace ripplenotch {

// The state of a prediction of a model along a motion: the change of torque by a changed term is computed
// from the stored results of the other terms.

struct Prediction::State {
    /// A change of a ripple, a complex number a sample, takes as long as so many torques.
    static constexpr std::size_t cost_of_change = 2;

    // Torques of a ripple of gain 1, and of gain i: any gain makes a sum of them.
    struct Phasor {
        std::vector<double> along_nm, across_nm;
    };

    Model model;
    const Motion& logged;
    std::optional<Motion> changed;
    GearRatio ratio;
    std::vector<double> load, joint_nm, torque_nm;
    std::map<std::size_t, std::vector<double>> own_nm;  ///< torque of each term that was requested
    std::map<double, Gain> gains;
    std::map<std::size_t, Phasor> phasors;
    std::map<double, Gain> rest;  ///< the gains without the change at rest_place
    std::size_t rest_place = 0;
    bool load_is_used = false, sum_is_linear = true;
    Carriers* carriers;
    std::vector<double> plain_nm;  ///< torque of the joint terms that are no ripple, once requested
    bool is_ripple_anew = false;   ///< all but its ripple was taken over
    std::size_t changes = 0;       ///< number of terms that change the ripple
    std::size_t applied = 0;

    State(Model given, const Motion& motion, Carriers* kept)
        : model(std::move(given)), logged(motion), ratio(model.gear_ratio), carriers(kept) {
        refuse_missing_values(model);
        changed = motion_behind(model, logged, ratio);
        // Carriers are of the motion as it was logged, whatever the gear ratio.
        if (changed && changed->position_deg != logged.position_deg) carriers = nullptr;
        load = load_nm(model, situation({}));
        load_is_used = !load.empty();
        for (const Term& term : model.terms) {
            if (!term.effect->chance && !term.effect->linear_in_torque) sum_is_linear = false;
            if (side_of(term) == Side::ripple) ++changes;
        }
        applied = model.terms.size();
        joint_nm = motion.known_nm;
        joint_nm.resize(motion.size());
        for (const Term& term : model.terms) {
            if (term.effect->side == Side::joint) add(term, situation(load), gain(term), joint_nm);
        }
        torque_nm = joint_nm;
        through_sensors(model, load, torque_nm);
    }

    // `before` with a term that changes its ripple alone: a change of the ripple, or of the gear ratio.
    State(State& before, Model given, GearRatio with_ratio)
        : model(std::move(given)),
          logged(before.logged),
          changed(before.changed),
          ratio(with_ratio),
          load_is_used(false),
          carriers(before.carriers),
          is_ripple_anew(true) {
        for (const Term& term : model.terms) {
            if (!term.effect->chance && !term.effect->linear_in_torque) sum_is_linear = false;
            if (side_of(term) == Side::ripple) ++changes;
        }
        joint_nm = before.plain();
        for (const Term& term : model.terms) {
            if (term.effect->side != Side::joint || !term.effect->ripple_order) continue;
            ++applied;
            add(term, situation(load), gain(term), joint_nm);
        }
        torque_nm = joint_nm;
        through_sensors(model, load, torque_nm);
    }

    const std::vector<double>& plain() {
        if (!plain_nm.empty()) return plain_nm;
        plain_nm = logged.known_nm;
        plain_nm.resize(joint_nm.size());
        for (std::size_t i = 0; i < model.terms.size(); ++i) {
            if (model.terms[i].effect->side != Side::joint || model.terms[i].effect->ripple_order) continue;
            const std::vector<double>& torque = own(i);
            for (std::size_t k = 0; k < plain_nm.size(); ++k) plain_nm[k] += torque[k];
        }
        return plain_nm;
    }

    // The gear ratio that the ripple has with the term, where the term changes ripple alone.
    [[nodiscard]] std::optional<GearRatio> ratio_of_ripple(const Term& term) const {
        const Effect& effect = *term.effect;
        if (load_is_used || effect.uses_load || !effect.linear_in_torque) return std::nullopt;
        if (side_of(term) == Side::ripple) return ratio;
        if (effect.side != Side::motion) return std::nullopt;
        Motion other = seen();
        GearRatio other_ratio = ratio;
        effect.change_motion(values_of(term), other, other_ratio);
        if (other.position_deg != seen().position_deg || other.velocity_deg_s != seen().velocity_deg_s ||
            other.acceleration_deg_s2 != seen().acceleration_deg_s2)
            return std::nullopt;
        return other_ratio;
    }

    [[nodiscard]] std::size_t cost_of_whole() const {
        std::size_t cost = model.terms.size();
        for (const Term& term : model.terms) cost += term.effect->ripple_order ? cost_of_change * changes : 0;
        return cost;
    }

    [[nodiscard]] const Motion& seen() const { return changed ? *changed : logged; }

    [[nodiscard]] Situation situation(std::span<const double> with_load) const {
        return {.motion = seen(), .ratio = ratio, .load_nm = with_load};
    }

    void through_sensors(const Model& of, std::span<const double> with_load,
                         std::vector<double>& torque) const {
        for (const Side side : {Side::sensor, Side::converter}) {
            each(of, side, [&](const Effect& effect, const std::vector<double>& values) {
                if (!effect.chance) effect.apply(situation(with_load), values, torque);
            });
        }
    }

    void add(const Term& term, const Situation& around, const Gain& with_gain,
             std::vector<double>& torque) const {
        if (carriers != nullptr && carriers->add_torque(term, around, with_gain, torque)) return;
        add_torque(term, around, with_gain, torque);
    }

    // The torque of a joint term of this model, as it is.
    const std::vector<double>& own(std::size_t place) {
        auto [entry, is_new] = own_nm.try_emplace(place);
        if (!is_new) return entry->second;
        const Term& term = model.terms[place];
        entry->second.assign(joint_nm.size(), 0.0);
        ++applied;
        add(term, situation(load), gain(term), entry->second);
        return entry->second;
    }

    // The gain of a ripple in this model, its own or a new one.
    const Gain& gain(const Term& term) {
        static const Gain none;
        if (!term.effect->ripple_order) return none;
        const double order = values_of(term)[*term.effect->ripple_order];
        const auto [entry, is_new] = gains.try_emplace(order);
        if (is_new) {
            entry->second = gain_of(model, situation(load), order);
            applied += cost_of_change * changes;
        }
        return entry->second;
    }

    const std::vector<double>& of_gain(std::size_t place, std::complex<double> unit,
                                       std::vector<double>& torque) {
        if (!torque.empty()) return torque;
        torque.assign(joint_nm.size(), 0.0);
        add(model.terms[place], situation(load), Gain(joint_nm.size(), unit), torque);
        ++applied;
        return torque;
    }

    // Gain of an order by all changes but that of the term at `place`.
    const Gain& rest_of_gain(std::size_t place, double order) {
        if (place != rest_place) rest.clear();
        rest_place = place;
        const auto [entry, is_new] = rest.try_emplace(order, joint_nm.size(), 1.0);
        if (!is_new) return entry->second;
        for (std::size_t i = 0; i < model.terms.size(); ++i) {
            const Effect& effect = *model.terms[i].effect;
            if (side_of(model.terms[i]) != Side::ripple || i == place) continue;
            effect.change_ripple(situation(load), Order(order), values_of(model.terms[i]), entry->second);
            applied += cost_of_change;
        }
        return entry->second;
    }

    // `other` has another change of the ripple at `place`.
    [[nodiscard]] std::vector<double> difference_of_ripple(const Model& other, std::size_t place,
                                                           std::span<const double> with_load) {
        const Term& changing = other.terms[place];
        std::vector<double> sum(joint_nm.size(), 0.0);
        for (std::size_t i = 0; i < model.terms.size(); ++i) {
            const Term& term = model.terms[i];
            if (term.effect->side != Side::joint || !term.effect->ripple_order) continue;
            const double order = values_of(term)[*term.effect->ripple_order];
            Gain now = rest_of_gain(place, order);
            changing.effect->change_ripple(situation(with_load), Order(order), values_of(changing), now);
            applied += cost_of_change;
            const Gain& before = gain(term);
            const bool plain = before.empty();
            bool turns = false;
            for (std::size_t k = 0; k < now.size(); ++k) {
                now[k] -= plain ? 1.0 : before[k];
                turns = turns || now[k].imag() != 0.0;
            }
            Phasor& phasor = phasors[i];
            const auto& along_nm = of_gain(i, 1.0, phasor.along_nm);
            for (std::size_t k = 0; k < now.size(); ++k) sum[k] += now[k].real() * along_nm[k];
            if (!turns) continue;
            const auto& across_nm = of_gain(i, {0.0, 1.0}, phasor.across_nm);
            for (std::size_t k = 0; k < now.size(); ++k) sum[k] += now[k].imag() * across_nm[k];
        }
        through_sensors(other, with_load, sum);
        return sum;
    }

    // `other` differs from this model in term `place` alone, or has it besides.
    [[nodiscard]] std::vector<double> difference_to(const Model& other, std::size_t place) {
        const Effect& effect = *other.terms[place].effect;
        const Side side = side_of(other.terms[place]);
        if (side == Side::sensor && !changes_motion(other.terms[place]))
            return difference_behind_joint(other);
        if (!sum_is_linear || (side != Side::joint && side != Side::ripple))
            return difference_as_a_whole(other);
        const bool loads = (effect.bears_load && load_is_used) || (effect.uses_load && !load_is_used);
        const std::vector<double> other_load = loads ? load_nm(other, situation({})) : std::vector<double>();
        const std::vector<double>& with_load = loads ? other_load : load;
        if (side == Side::ripple) return difference_of_ripple(other, place, with_load);
        const bool ripple = loads && effect.bears_load;
        std::vector<double> sum(joint_nm.size(), 0.0);
        for (std::size_t i = 0; i < other.terms.size(); ++i) {
            const Term& term = other.terms[i];
            const bool concerned = i == place || (loads && effect.bears_load && term.effect->uses_load) ||
                                   (ripple && term.effect->ripple_order);
            if (term.effect->side != Side::joint || !concerned) continue;
            const Situation around = situation(with_load);
            applied += ripple ? 1 + changes : 1;
            add(term, around, ripple ? gain_for(other, term, around) : gain(term), sum);
            if (i < model.terms.size()) add_scaled(-1.0, own(i).data(), sum.data(), sum.size());
        }
        through_sensors(other, with_load, sum);
        return sum;
    }

    [[nodiscard]] std::vector<double> difference_behind_joint(const Model& other) {
        ++applied;
        std::vector<double> torque = joint_nm;
        through_sensors(other, load, torque);
        add_scaled(-1.0, torque_nm.data(), torque.data(), torque.size());
        return torque;
    }

    [[nodiscard]] std::vector<double> difference_as_a_whole(const Model& other) {
        applied += cost_of_whole();
        std::vector<double> torque = predict_nm(other, logged);
        for (std::size_t k = 0; k < torque.size(); ++k) torque[k] -= torque_nm[k];
        return torque;
    }
};

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
