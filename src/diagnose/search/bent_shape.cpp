// SPDX-License-Identifier: MIT
#include "diagnose/search/bent_shape.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "ripplenotch/core/portable_math.hpp"
#include "ripplenotch/model/prediction.hpp"

namespace ripplenotch {

namespace {

double in_two_digits(double value) {
    double unit = 1.0;
    while (value >= 100.0 * unit) unit *= 10.0;
    while (value < 10.0 * unit) unit *= 0.1;
    return std::round(value / unit) * unit;
}

// The values with which a term is evaluated, stated from another speed, and what that makes of its ripple.
struct Restated {
    std::vector<double> values;
    double ripple = 1.0;
};

Restated restated(const Term& term, double from_deg_s) {
    Restated made{values_of(term)};
    made.ripple = term.effect->restate(from_deg_s, made.values);
    return made;
}

bool is_allowed(const Effect& effect, const Restated& made) {
    if (!std::isfinite(made.ripple) || made.ripple == 0.0) return false;
    for (std::size_t p = 0; p < made.values.size(); ++p) {
        if (!allows(effect.parameters[p], made.values[p])) return false;
    }
    return true;
}

// Places of the ripple terms that it changes; empty where the size or the phase of one is not fitted.
std::vector<std::size_t> ripple_of(const Candidate& model, std::size_t changing) {
    const Term& change = model.stated.terms[changing];
    const auto order = find_parameter(*change.effect, "order");
    std::vector<std::size_t> places;
    for (std::size_t t = 0; t < model.open.terms.size(); ++t) {
        const Effect& effect = *model.open.terms[t].effect;
        if (!effect.ripple_order) continue;
        const double only = order ? change.values[*order].value_or(0.0) : 0.0;
        if (only != 0.0 && only != model.stated.terms[t].values[*effect.ripple_order]) continue;
        const auto& open = model.open.terms[t].values;
        if (!effect.polar || open[effect.polar->size] || open[effect.polar->phase]) return {};
        places.push_back(t);
    }
    return places;
}

void multiply(Term& ripple, double by) {
    auto& size = *ripple.values[ripple.effect->polar->size];
    auto& phase_deg = *ripple.values[ripple.effect->polar->phase];
    size *= std::abs(by);
    if (by < 0.0) phase_deg += phase_deg > 0.0 ? -180.0 : 180.0;
}

}  // namespace

double usual_speed_deg_s(const Case& looked_at) {
    double squares = 0.0, samples = 0.0;
    for (std::size_t k = 0; k < looked_at.size(); ++k) {
        const double v = looked_at.motion.velocity_deg_s[k];
        if (looked_at.use[k] == 0 || std::abs(v) < looked_at.moving_deg_s) continue;
        squares += v * v;
        samples += 1.0;
    }
    return squares > 0.0 ? in_two_digits(std::sqrt(squares / samples)) : 0.0;
}

void state_where_told(Candidate& model, const Case& looked_at, const DiagnosisRules& rules) {
    for (std::size_t t = 0; t < model.stated.terms.size() && t < model.prices.size(); ++t) {
        Term &stated = model.stated.terms[t], &open = model.open.terms[t];
        const Effect& effect = *stated.effect;
        if (!effect.restate || !(model.prices[t] > 0.0)) continue;
        const double usual_deg_s = usual_speed_deg_s(looked_at);
        const std::vector<std::size_t> ripple = ripple_of(model, t);
        if (!(usual_deg_s > 0.0) || ripple.empty()) continue;
        // Amplitude at rest and at the usual speed, in that of the term.
        const double rest = restated(stated, 0.0).ripple, usual = restated(stated, usual_deg_s).ripple;
        const double from_deg_s =
            std::abs(rest) < rules.search.least_at_rest * std::abs(usual) ? usual_deg_s : 0.0;
        if (stated.values[*effect.stated_from].value_or(0.0) == from_deg_s) continue;
        const Restated made = restated(stated, from_deg_s);
        if (!is_allowed(effect, made)) continue;
        for (std::size_t p = 0; p < made.values.size(); ++p) {
            if (stated.values[p]) stated.values[p] = made.values[p];
        }
        stated.values[*effect.stated_from] = open.values[*effect.stated_from] = from_deg_s;
        for (const std::size_t place : ripple) multiply(model.stated.terms[place], made.ripple);
    }
}

namespace {

class Shapes {
  public:
    Shapes(const ModelBench& bench, const Model& stated, std::size_t term)
        : bench_(bench), term_(stated.terms[term]), rest_(without(stated, term), bench.looked_at().motion) {
        own_ = torque_at(term_);
    }

    // By how much of it the torque differs from that at the bound, where that is as good.
    [[nodiscard]] std::optional<double> as_good_at(std::size_t parameter, double bound) const {
        const std::vector<double> there = torque_at(moved(parameter, bound));
        const double off = difference(own_, there), as_good = bench_.rules().shape.as_good;
        if (!(off < as_good)) return std::nullopt;
        // A bound that is as good as neutral is no particular shape.
        const double neutral = term_.effect->parameters[parameter].neutral;
        if (difference(torque_at(moved(parameter, neutral)), there) < as_good) return std::nullopt;
        return off;
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

    // Part of a torque that the best multiple of the other leaves; 1 where that has the other sign.
    [[nodiscard]] static double difference(const std::vector<double>& torque,
                                           const std::vector<double>& other) {
        double square = 0.0, both = 0.0, others = 0.0;
        for (std::size_t r = 0; r < torque.size(); ++r) {
            square += torque[r] * torque[r];
            both += torque[r] * other[r];
            others += other[r] * other[r];
        }
        if (!(both > 0.0)) return 1.0;
        return std::sqrt(std::max(square - both * both / others, 0.0) / square);
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

// What is lost when it is held within its bound; much, where the log wants it there.
double lost_within(const ModelBench& bench, const Candidate& model, const FittedValue& value) {
    const Parameter& parameter = model.stated.terms[value.term].effect->parameters[value.parameter];
    const bool at_lower = value.value - parameter.lower < parameter.upper - value.value;
    const double inward = bench.rules().shape.inward_part * (parameter.upper - parameter.lower);
    const double factor = bench.rules().shape.inward_factor;
    double within = value.value + (at_lower ? inward : -inward);
    if (parameter.lower > 0.0) within = at_lower ? value.value * factor : value.value / factor;
    Model held = model.open, guess = model.stated;
    held.terms[value.term].values[value.parameter] = guess.terms[value.term].values[value.parameter] = within;
    return bench.fitted(held, guess, model.prices).gain_left - model.gain_left;
}

}  // namespace

Bend bend_of(const ModelBench& bench, const Candidate& model, std::size_t term) {
    const Effect& effect = *model.stated.terms[term].effect;
    const Term& stated = model.stated.terms[term];
    if (const auto damping = find_parameter(effect, "damping"); damping && side_of(stated) != effect.side) {
        if (const double value = *stated.values[*damping]; value >= bench.rules().shape.most_damping)
            return {effect.parameters[*damping].name, "shape.most_damping", value};
    }
    const Shapes shapes(bench, model.stated, term);
    for (const FittedValue& value : model.values) {
        const Parameter& parameter = effect.parameters[value.parameter];
        if (value.term != term || !is_shape(effect, value.parameter)) continue;
        if (effect.polar && effect.polar->phase == value.parameter) continue;
        if (value.at_bound && !is_neutral(parameter, value.value)) {
            const double lost = lost_within(bench, model, value);
            if (lost > bench.rules().judge.tie_margin) return {parameter.name, "judge.tie_margin", lost};
        }
        for (const double bound : {parameter.lower, parameter.upper}) {
            if (is_neutral(parameter, bound)) continue;
            if (const auto off = shapes.as_good_at(value.parameter, bound))
                return {parameter.name, "shape.as_good", *off};
        }
    }
    return {};
}

}  // namespace ripplenotch
