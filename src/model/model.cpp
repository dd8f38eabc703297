// SPDX-License-Identifier: MIT
#include "ripplenotch/model/model.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <utility>

#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/spec.hpp"

namespace ripplenotch {
namespace {

std::size_t known_parameter(const Effect& effect, const std::string& name) {
    if (const auto place = find_parameter(effect, name)) return *place;
    std::vector<std::string> known;
    for (const Parameter& parameter : effect.parameters) known.emplace_back(parameter.name);
    const auto near = nearest_name(name, known);
    raise<UsageError>("effect {} has no parameter '{}'{}; its parameters: {}", effect.name, name,
                      near ? fmt::format(" (did you mean {}?)", *near) : "", fmt::join(known, ", "));
}

}  // namespace

Term parse_term(std::string_view text) {
    const Spec spec = parse_spec(text);
    const Effect& effect = find_effect(spec.name);
    Term term{&effect, std::vector<std::optional<double>>(effect.parameters.size())};
    for (const auto& [name, value_text] : spec.values) {
        const std::size_t place = known_parameter(effect, name);
        const Parameter& parameter = effect.parameters[place];
        const std::string label = fmt::format("effect {}, {}", effect.name, name);
        const double value = parse_quantity(value_text, dimension_of(parameter), label);
        if (!allows(parameter, value)) {
            raise<UsageError>("{}: {} is not between {} and {} {}", label, value_text,
                              shortest(parameter.lower), shortest(parameter.upper), parameter.unit);
        }
        term.values[place] = value;
    }
    return term;
}

double most_in(const Model& model, const Effect& effect, std::size_t parameter) {
    const Parameter& described = effect.parameters[parameter];
    const bool is_step = effect.resists && described.name == "width_deg_s" && model.widest_step_deg_s > 0.0;
    return is_step ? std::clamp(model.widest_step_deg_s, described.start, described.upper) : described.upper;
}

double least_in(const Model& model, const Effect& effect, std::size_t parameter) {
    const Parameter& described = effect.parameters[parameter];
    const bool has_size_alone = std::ranges::all_of(
        effect.parameters, [](const Parameter& one) { return one.linear || one.name == "width_deg_s"; });
    const bool may_be_too_much =
        model.beside_simulation && effect.resists && has_size_alone && parameter == 0;
    return may_be_too_much ? -described.upper : described.lower;
}

Side side_of(const Term& term) {
    const auto& whole = term.effect->whole;
    return whole && term.values[*whole].value_or(0.0) >= 0.5 ? Side::sensor : term.effect->side;
}

std::vector<double> values_of(const Term& term) {
    std::vector<double> values;
    for (std::size_t p = 0; p < term.values.size(); ++p) {
        const Parameter& parameter = term.effect->parameters[p];
        values.push_back(parameter.left_out == LeftOut::assumed ? term.values[p].value_or(parameter.start)
                                                                : term.values[p].value());
    }
    return values;
}

GearAccount gear_of(const Model& model, std::string source) {
    std::vector<Order> orders;
    for (const Term& term : model.terms) {
        const auto place = term.effect->ripple_order;
        if (place && term.values[*place]) orders.emplace_back(*term.values[*place]);
    }
    std::sort(orders.begin(), orders.end());
    orders.erase(std::unique(orders.begin(), orders.end()), orders.end());
    return {model.gear_ratio, std::move(orders), {}, {}, std::move(source)};
}

std::vector<std::string> missing_values(const Model& model) {
    std::vector<std::string> names;
    for (std::size_t i = 0; i < model.terms.size(); ++i) {
        const Term& term = model.terms[i];
        for (std::size_t p = 0; p < term.values.size(); ++p) {
            const Parameter& parameter = term.effect->parameters[p];
            if (term.values[p] || parameter.left_out == LeftOut::assumed) continue;
            names.push_back(fmt::format("effects[{}].{} of {}", i, parameter.name, term.effect->name));
        }
    }
    return names;
}

}  // namespace ripplenotch
