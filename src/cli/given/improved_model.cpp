// SPDX-License-Identifier: MIT
// What a diagnosis found of the given terms, as a part of the improved model.

#include "cli/given/given_terms.hpp"
#include "ripplenotch/core/number.hpp"

namespace ripplenotch {
namespace {

std::vector<double> values_named(const Diagnosis& diagnosis, std::string_view name) {
    std::vector<double> values;
    for (const GivenValue& given : diagnosis.given) {
        if (given.name == name) values.push_back(given.value);
    }
    return values;
}

// A scale that nothing has shown to be another is 1; one that was found is an effect of the model.
SimulatedTerm fitted(SimulatedTerm simulated) {
    simulated.scale = simulated.scale.value_or(1.0);
    return simulated;
}

StatedArm fitted(const GivenTerms& given, const Diagnosis& diagnosis) {
    StatedArm arm = *given.arm;
    if (!given.fitted_arm) return arm;
    GivenArm& found = *given.fitted_arm;
    const std::size_t joint = *arm.chain.find(arm.joint);
    const ArmFit& fit = found.fit(joint);
    ArmValues values = arm_values(found.chain(), fit, joint, values_named(diagnosis, "arm"));
    for (double& value : values.links) value = to_digits(value);
    values.rotor_inertia_kgm2 = to_digits(values.rotor_inertia_kgm2);
    arm.values = std::move(values);
    arm.smoothing = fit.smoothing;
    return arm;
}

// What was fitted has no more digits in the model than in the story and its JSON.
Model with_fitted_digits(Model model) {
    for (Term& term : model.terms) {
        for (std::optional<double>& value : term.values) {
            if (value) value = to_digits(*value);
        }
    }
    return model;
}

}  // namespace

ModelWithGiven improved_model(const GivenTerms& given, const Diagnosis& diagnosis) {
    ModelWithGiven model{with_fitted_digits(diagnosis.model)};
    if (given.simulated) model.simulated = fitted(*given.simulated);
    if (given.arm) model.arm = fitted(given, diagnosis);
    return model;
}

}  // namespace ripplenotch
