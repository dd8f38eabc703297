// SPDX-License-Identifier: MIT
#include "diagnose/search/bent_shape.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "ripplenotch/model/prediction.hpp"

namespace ripplenotch {
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
