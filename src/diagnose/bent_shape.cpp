// SPDX-License-Identifier: MIT
#include "diagnose/bent_shape.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "diagnose/search.hpp"
#include "ripplenotch/model/prediction.hpp"

namespace ripplenotch {
namespace {

// Torques of which no more than this part differs, whatever their size, are as good as one another.
constexpr double as_good = 0.1;

class Shapes {
  public:
    Shapes(const ModelBench& bench, const Model& stated, std::size_t term)
        : bench_(bench), term_(stated.terms[term]), rest_(without(stated, term), bench.looked_at().motion) {
        own_ = torque_at(term_);
    }

    [[nodiscard]] bool as_good_at(std::size_t parameter, double bound) const {
        const std::vector<double> there = torque_at(moved(parameter, bound));
        if (!alike(own_, there)) return false;
        // A bound that is as good as neutral is no particular shape.
        const double neutral = term_.effect->parameters[parameter].neutral;
        return !alike(torque_at(moved(parameter, neutral)), there);
    }

  private:
    static Model without(Model stated, std::size_t term) {
        stated.terms.erase(stated.terms.begin() + static_cast<std::ptrdiff_t>(term));
        return stated;
    }

    [[nodiscard]] Term moved(std::size_t parameter, double value) const {
        Term term = term_;
        term.values[parameter] = value;
        return term;
    }

    [[nodiscard]] std::vector<double> torque_at(const Term& term) const {
        const auto added = rest_.added(term);
        std::vector<double> torque_nm;
        for (const std::size_t k : bench_.rows()) torque_nm.push_back(added[k]);
        return torque_nm;
    }

    // Whatever the size of the one.
    static bool alike(const std::vector<double>& torque, const std::vector<double>& other) {
        double square = 0.0, both = 0.0, others = 0.0;
        for (std::size_t r = 0; r < torque.size(); ++r) {
            square += torque[r] * torque[r];
            both += torque[r] * other[r];
            others += other[r] * other[r];
        }
        // What the best multiple of the other leaves.
        return both > 0.0 && square - both * both / others < as_good * as_good * square;
    }

    const ModelBench& bench_;
    Term term_;
    Prediction rest_;
    std::vector<double> own_;
};

bool is_shape(const Effect& effect, std::size_t p) {
    const Parameter& parameter = effect.parameters[p];
    // Angles come round, and signed numbers are sizes.
    return !parameter.linear && parameter.left_out == LeftOut::fitted && parameter.lower != -parameter.upper;
}

bool is_neutral(const Parameter& parameter, double value) {
    // A logarithm and back is off by rounding.
    return std::abs(value - parameter.neutral) <= 1e-6 * std::max(1.0, std::abs(parameter.neutral));
}

// Held within its bound it does clearly worse.
bool leans_on(const ModelBench& bench, const Candidate& model, const FittedValue& value) {
    const Parameter& parameter = model.stated.terms[value.term].effect->parameters[value.parameter];
    const bool at_lower = value.value - parameter.lower < parameter.upper - value.value;
    const double inward = 0.05 * (parameter.upper - parameter.lower);
    double within = value.value + (at_lower ? inward : -inward);
    if (parameter.lower > 0.0) within = value.value * (at_lower ? 2.0 : 0.5);
    Model held = model.open, guess = model.stated;
    held.terms[value.term].values[value.parameter] = guess.terms[value.term].values[value.parameter] = within;
    return bench.fitted(held, guess, model.prices).gain_left > model.gain_left + tie_margin;
}

}  // namespace

std::string_view bent_parameter(const ModelBench& bench, const Candidate& model, std::size_t term) {
    const Effect& effect = *model.stated.terms[term].effect;
    const Shapes shapes(bench, model.stated, term);
    for (const FittedValue& value : model.values) {
        const Parameter& parameter = effect.parameters[value.parameter];
        if (value.term != term || !is_shape(effect, value.parameter)) continue;
        if (effect.polar && effect.polar->phase == value.parameter) continue;
        if (value.at_bound && !is_neutral(parameter, value.value) && leans_on(bench, model, value))
            return parameter.name;
        for (const double bound : {parameter.lower, parameter.upper}) {
            if (!is_neutral(parameter, bound) && shapes.as_good_at(value.parameter, bound))
                return parameter.name;
        }
    }
    return {};
}

}  // namespace ripplenotch
