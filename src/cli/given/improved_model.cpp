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

double value_named(const Diagnosis& diagnosis, std::string_view name) {
    const auto values = values_named(diagnosis, name);
    return values.empty() ? 0.0 : to_digits(values.front());
}

SimulatedTerm fitted(SimulatedTerm simulated, const Diagnosis& diagnosis) {
    const auto own = values_named(diagnosis, "simulated");
    simulated.scale = to_digits(own.at(0));
    if (simulated.fit_delay && *simulated.scale != 0.0)
        simulated.delay_s += to_digits(own.at(1) / *simulated.scale);
    simulated.fit_delay = false;
    simulated.offset_nm = value_named(diagnosis, "offset_nm");
    simulated.inertia_kgm2 = value_named(diagnosis, "inertia_kgm2");
    simulated.gravity_cosine_nm = value_named(diagnosis, "gravity_cosine_nm");
    simulated.gravity_sine_nm = value_named(diagnosis, "gravity_sine_nm");
    return simulated;
}

StatedArm fitted(const GivenTerms& given, const Diagnosis& diagnosis) {
    StatedArm arm = *given.arm;
    // Beside a simulation the offset is the simulation's.
    if (!given.simulated) arm.nuisance.offset_nm = value_named(diagnosis, "offset_nm");
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

void add_stated_nuisance(const GivenTerms& given, Diagnosis& diagnosis) {
    const auto add = [&](std::string_view name, double stated) {
        for (GivenValue& value : diagnosis.given) {
            if (value.name == name) value.value += stated;
        }
    };
    if (given.simulated) {
        add("offset_nm", given.simulated->offset_nm);
        add("inertia_kgm2", given.simulated->inertia_kgm2);
        add("gravity_cosine_nm", given.simulated->gravity_cosine_nm);
        add("gravity_sine_nm", given.simulated->gravity_sine_nm);
    } else if (given.arm) {
        add("offset_nm", given.arm->nuisance.offset_nm);
    }
}

ModelWithGiven improved_model(const GivenTerms& given, const Diagnosis& diagnosis) {
    ModelWithGiven model{with_fitted_digits(diagnosis.model)};
    if (given.simulated) model.simulated = fitted(*given.simulated, diagnosis);
    if (given.arm) model.arm = fitted(given, diagnosis);
    return model;
}

}  // namespace ripplenotch
