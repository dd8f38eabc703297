// SPDX-License-Identifier: MIT
#include "diagnose/search/stated_speed.hpp"

#include <cmath>

#include "ripplenotch/core/portable_math.hpp"

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

}  // namespace ripplenotch
