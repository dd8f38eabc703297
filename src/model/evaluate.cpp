// SPDX-License-Identifier: MIT
// A model along a motion: motion effects first, then ripple gains, then the sum of torques, then the chain of
// sensor and converter. docs/decisions/0005-sides.md says why in this order.

#include <fmt/ranges.h>

#include <map>

#include "ripplenotch/core/error.hpp"
#include "ripplenotch/model/model.hpp"
#include "ripplenotch/model/prediction.hpp"

namespace ripplenotch {
namespace {

using Gain = std::vector<std::complex<double>>;

template <class Action>
void each(const Model& model, Side side, const Action& action) {
    for (const Term& term : model.terms) {
        if (term.effect->side == side) action(*term.effect, values_of(term));
    }
}

bool has(const Model& model, bool (*property)(const Effect&)) {
    for (const Term& term : model.terms) {
        if (property(*term.effect)) return true;
    }
    return false;
}

// Torque of what bears load; nothing when no effect asks for it.
std::vector<double> load_nm(const Model& model, const Situation& situation) {
    std::vector<double> load;
    if (!has(model, [](const Effect& effect) { return effect.uses_load; })) return load;
    load.resize(situation.motion.size());
    each(model, Side::joint, [&](const Effect& effect, const std::vector<double>& values) {
        if (effect.bears_load) effect.apply(situation, values, load);
    });
    return load;
}

// Of a ripple term of the order given; empty when nothing changes the model's ripple.
Gain gain_of(const Model& model, const Situation& situation, double order) {
    if (!has(model, [](const Effect& effect) { return effect.side == Side::ripple; })) return {};
    Gain gain(situation.motion.size(), 1.0);
    each(model, Side::ripple, [&](const Effect& change, const std::vector<double>& numbers) {
        change.change_ripple(situation, Order(order), numbers, gain);
    });
    return gain;
}

void add_joint_torque(const Model& model, const Situation& situation, std::span<double> torque_nm) {
    each(model, Side::joint, [&](const Effect& effect, const std::vector<double>& values) {
        Situation with_gain = situation;
        Gain gain;
        if (effect.ripple_order) gain = gain_of(model, situation, values[*effect.ripple_order]);
        with_gain.ripple_gain = gain;
        effect.apply(with_gain, values, torque_nm);
    });
}

std::vector<double> evaluate(const Model& model, const Motion& logged, std::span<const double> noise_nm,
                             Chance chance) {
    if (const auto missing = missing_values(model); !missing.empty()) {
        raise<UsageError>("the model does not state {}; give the value, or fit it to a log first",
                          fmt::join(missing, ", "));
    }
    GearRatio ratio = model.gear_ratio;
    std::optional<Motion> changed;
    each(model, Side::motion, [&](const Effect& effect, const std::vector<double>& values) {
        if (!changed) changed = logged;
        effect.change_motion(values, *changed, ratio);
    });
    const Motion& motion = changed ? *changed : logged;
    const auto load = load_nm(model, {.motion = motion, .ratio = ratio});
    const Situation situation{.motion = motion, .ratio = ratio, .load_nm = load};
    std::vector<double> torque_nm(motion.size(), 0.0);
    add_joint_torque(model, situation, torque_nm);
    const auto transform = [&](const Effect& effect, const std::vector<double>& values) {
        if (chance == Chance::acts || !effect.chance) effect.apply(situation, values, torque_nm);
    };
    each(model, Side::sensor, transform);
    for (std::size_t k = 0; k < noise_nm.size(); ++k) torque_nm[k] += noise_nm[k];
    each(model, Side::converter, transform);
    return torque_nm;
}

}  // namespace

std::vector<double> predict_nm(const Model& model, const Motion& motion) {
    return evaluate(model, motion, {}, Chance::left_out);
}

std::vector<double> measure_nm(const Model& model, const Motion& motion, std::span<const double> noise_nm,
                               Chance chance) {
    return evaluate(model, motion, noise_nm, chance);
}

struct Prediction::State {
    Model model;
    const Motion& logged;
    std::optional<Motion> changed;
    GearRatio ratio;
    std::vector<double> load, torque_nm;
    std::map<double, Gain> gains;
    bool load_is_used = false, sum_is_linear = true;

    State(Model given, const Motion& motion)
        : model(std::move(given)),
          logged(motion),
          ratio(model.gear_ratio),
          torque_nm(predict_nm(model, motion)) {
        each(model, Side::motion, [&](const Effect& effect, const std::vector<double>& values) {
            if (!changed) changed = logged;
            effect.change_motion(values, *changed, ratio);
        });
        load = load_nm(model, {.motion = seen(), .ratio = ratio});
        load_is_used = !load.empty();
        for (const Term& term : model.terms) {
            if (!term.effect->chance && !term.effect->linear_in_torque) sum_is_linear = false;
        }
    }

    [[nodiscard]] const Motion& seen() const { return changed ? *changed : logged; }

    // A joint effect whose torque no other effect looks at adds to the sum, and nothing else comes of it.
    [[nodiscard]] bool stands_alone(const Effect& effect) const {
        return effect.side == Side::joint && sum_is_linear && !(effect.bears_load && load_is_used) &&
               !(effect.uses_load && !load_is_used);
    }

    void add_alone(const Term& term, double factor, std::vector<double>& sum) {
        const auto values = values_of(term);
        Situation situation{.motion = seen(), .ratio = ratio, .load_nm = load};
        if (term.effect->ripple_order) {
            const double order = values[*term.effect->ripple_order];
            if (!gains.contains(order)) gains[order] = gain_of(model, situation, order);
            situation.ripple_gain = gains[order];
        }
        std::vector<double> own(sum.size(), 0.0);
        term.effect->apply(situation, values, own);
        for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += factor * own[k];
    }

    void through_sensors(std::vector<double>& torque) const {
        const Situation situation{.motion = seen(), .ratio = ratio, .load_nm = load};
        for (const Side side : {Side::sensor, Side::converter}) {
            each(model, side, [&](const Effect& effect, const std::vector<double>& values) {
                if (!effect.chance) effect.apply(situation, values, torque);
            });
        }
    }

    [[nodiscard]] std::vector<double> difference_to(const Model& other) const {
        std::vector<double> torque = predict_nm(other, logged);
        for (std::size_t k = 0; k < torque.size(); ++k) torque[k] -= torque_nm[k];
        return torque;
    }
};

Prediction::Prediction(Model model, const Motion& motion)
    : state_(std::make_unique<State>(std::move(model), motion)) {}
Prediction::~Prediction() = default;
Prediction::Prediction(Prediction&&) noexcept = default;
Prediction& Prediction::operator=(Prediction&&) noexcept = default;

const Model& Prediction::model() const { return state_->model; }
const std::vector<double>& Prediction::torque_nm() const { return state_->torque_nm; }

std::vector<double> Prediction::added(const Term& term) const {
    if (!state_->stands_alone(*term.effect)) {
        Model with = state_->model;
        with.terms.push_back(term);
        return state_->difference_to(with);
    }
    std::vector<double> torque(state_->torque_nm.size(), 0.0);
    state_->add_alone(term, 1.0, torque);
    state_->through_sensors(torque);
    return torque;
}

std::vector<double> Prediction::changed(std::size_t place, const Term& term) const {
    const Term& before = state_->model.terms.at(place);
    if (!state_->stands_alone(*term.effect)) {
        Model other = state_->model;
        other.terms[place] = term;
        return state_->difference_to(other);
    }
    std::vector<double> torque(state_->torque_nm.size(), 0.0);
    state_->add_alone(term, 1.0, torque);
    state_->add_alone(before, -1.0, torque);
    state_->through_sensors(torque);
    return torque;
}

}  // namespace ripplenotch
