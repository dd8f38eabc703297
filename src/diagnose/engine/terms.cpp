// SPDX-License-Identifier: MIT
#include "diagnose/engine/terms.hpp"

#include <algorithm>
#include <complex>

#include "diagnose/engine/recorded_motion.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch::engine {
namespace {

constexpr double friction_step_deg_s = 0.5;  // width of the step by which loads and ripples turn over
// A ratio decides where the sum of two speeds turns over: it is found with a friction as soft as a robot's
// and not with a step.
constexpr double coupled_step_deg_s = 2.0;
constexpr double payload_step_s = 0.5;  // in which the time of a change is refined

SearchedValue searched(const Effect& effect, std::string_view parameter, double lower, double upper,
                       std::vector<double> grid) {
    return {*find_parameter(effect, parameter), lower, upper, std::move(grid)};
}

std::vector<TermKind> make_term_kinds() {
    std::vector<TermKind> kinds;
    const auto add = [&](std::string_view name, Role role) -> TermKind& {
        TermKind kind;
        kind.effect = &find_effect(name);
        kind.role = role;
        kind.place = kinds.size();
        return kinds.emplace_back(std::move(kind));
    };
    const auto search = [](TermKind& kind, std::string_view parameter, double lower, double upper,
                           std::vector<double> grid, bool refined = true) {
        kind.searched.push_back(searched(*kind.effect, parameter, lower, upper, std::move(grid)));
        kind.is_refined = refined;
    };
    const auto assume = [](TermKind& kind, std::string_view parameter, double value) {
        kind.assumed.emplace_back(*find_parameter(*kind.effect, parameter), value);
    };
    assume(add("simulation-scale", Role::joint_torque), "error_percent", 1.0);
    add("inertia", Role::joint_torque);
    add("offset", Role::sensor_torque);
    add("viscous-friction", Role::joint_torque);
    add("quadratic-viscous-friction", Role::joint_torque);
    add("gravity", Role::joint_torque);
    TermKind& payload = add("payload-change", Role::joint_torque);
    search(payload, "time_s", 0.0, 1e6, {});
    payload.searched.back().step = payload_step_s;
    assume(add("asymmetric-friction", Role::joint_torque), "width_deg_s", friction_step_deg_s);
    add("asymmetric-viscous-friction", Role::joint_torque);
    TermKind& uneven = add("position-dependent-friction", Role::joint_torque);
    search(uneven, "order", 0.0, 1e4, {1.0, 2.0}, false);
    assume(uneven, "width_deg_s", friction_step_deg_s);
    TermKind& warm_up = add("friction-warm-up", Role::joint_torque);
    search(warm_up, "time_constant_s", 2.0, 200.0, {4.0, 10.0, 25.0});
    assume(warm_up, "width_deg_s", friction_step_deg_s);
    assume(add("load-friction", Role::joint_torque), "width_deg_s", friction_step_deg_s);
    TermKind& coupled = add("coupled-joint-friction", Role::joint_torque);
    search(coupled, "joint", 1.0, 100.0, {});
    coupled.searched.back().is_choice = true;
    // Nearer to 0 it is the Coulomb friction of this joint alone.
    search(coupled, "ratio", 0.25, 30.0,
           {-4.0, -2.0, -1.4, -1.0, -0.7, -0.5, -0.3, 0.3, 0.5, 0.7, 1.0, 1.4, 2.0, 4.0});
    coupled.searched.back().plain = 1.0;
    search(coupled, "width_deg_s", 0.03, coupled_step_deg_s, {coupled_step_deg_s});
    coupled.searched.back().may_be_at_bound = true;
    search(add("coulomb-friction", Role::joint_torque), "width_deg_s", 0.03, 8.0, {0.1, 0.4, 1.5});
    TermKind& stribeck = add("stribeck-friction", Role::joint_torque);
    search(stribeck, "stribeck_speed_deg_s", 0.8, 60.0, {2.0, 5.0, 12.0, 25.0});
    search(stribeck, "width_deg_s", 0.005, 3.0, {0.03, 0.2});
    TermKind& hysteresis = add("hysteresis", Role::joint_torque);
    search(hysteresis, "width_deg", 0.01, 15.0, {0.03, 0.1, 0.3, 1.0, 3.0, 8.0});
    hysteresis.searched.back().may_be_at_bound = true;
    search(add("backlash", Role::joint_torque), "width_deg", 0.05, 15.0, {0.2, 0.5, 1.0, 2.0, 4.0, 8.0});
    TermKind& ringing = add("start-stop-ringing", Role::joint_torque);
    search(ringing, "frequency_hz", 1.0, 12.0, {1.5, 2.0, 2.7, 3.6, 4.7, 6.2, 8.0});
    search(ringing, "decay_s", 0.02, 3.0, {0.3, 0.8});
    TermKind& drift = add("drift", Role::sensor_torque);
    search(drift, "time_constant_s", 2.0, 200.0, {4.0, 12.0, 40.0, 1e5});
    drift.searched.back().may_be_at_bound = true;
    search(add("tone", Role::sensor_torque), "frequency_hz", 0.0, 1e5, {}, false);
    TermKind& ripple = add("ripple", Role::joint_torque);
    search(ripple, "order", 0.0, 1e3, {}, false);
    ripple.may_occur_twice = true;
    TermKind& output_ripple = add("output-ripple", Role::joint_torque);
    search(output_ripple, "order", 0.0, 1e5, {2.0, 3.0, 4.0, 5.0, 6.0, 8.0}, false);
    output_ripple.may_occur_twice = true;
    add("ripple-speed-dependence", Role::ripple_change);
    add("ripple-load-dependence", Role::ripple_change);
    assume(add("ripple-direction-dependence", Role::ripple_change), "width_deg_s", friction_step_deg_s);
    search(add("ripple-modulation", Role::ripple_change), "output_order", 0.0, 1e4, {1.0, 2.0, 3.0}, false);
    search(add("gear-ratio", Role::motor_angle), "error_percent", 0.0, 1e5, {});
    search(add("velocity-bias", Role::motor_angle), "bias_deg_s", -100.0, 100.0, {});
    TermKind& eccentric = add("encoder-eccentricity", Role::motor_angle);
    search(eccentric, "amplitude_deg", 0.0, 10.0, {});
    search(eccentric, "phase_deg", -360.0, 720.0, {});
    eccentric.searched.back().step = 30.0;
    assume(eccentric, "order", 1.0);
    TermKind& resonance = add("resonance", Role::elastic_joint);
    search(resonance, "frequency_hz", 8.0, 200.0,
           {14.0, 16.89, 20.37, 24.57, 29.64, 35.75, 43.12, 52.01, 62.73, 75.66, 91.25, 110.0});
    // What is damped more is no resonance of a gear but the form of a filter.
    search(resonance, "damping", 0.005, 0.2, {0.05});
    assume(resonance, "whole", 1.0);
    TermKind& delay = add("delay", Role::sensor);
    search(delay, "delay_s", -0.04, 0.04,
           {-0.016, -0.008, -0.004, -0.0015, -0.0004, 0.0004, 0.0015, 0.004, 0.008, 0.016});
    delay.searched.back().may_be_at_bound = true;
    search(add("lag", Role::sensor), "time_constant_s", 0.0005, 0.08, {0.003, 0.01, 0.03});
    search(add("sensor-lowpass", Role::sensor), "cutoff_hz", 6.0, 200.0, {60.0, 25.0, 12.0});
    return kinds;
}

bool is_linear(const Effect& effect, std::size_t parameter) {
    const auto& polar = effect.polar;
    return effect.parameters[parameter].linear || (polar && polar->phase == parameter);
}

std::size_t linear_values(const Effect& effect) {
    std::size_t count = 0;
    for (std::size_t p = 0; p < effect.parameters.size(); ++p) count += is_linear(effect, p) ? 1 : 0;
    return count;
}

}  // namespace

std::span<const TermKind> term_kinds() {
    static const std::vector<TermKind> kinds = make_term_kinds();
    return kinds;
}

const TermKind& term_kind(std::string_view effect) {
    return *std::ranges::find_if(term_kinds(), [&](const TermKind& k) { return k.effect->name == effect; });
}

bool contains(const SearchedTerms& terms, std::string_view effect) {
    return std::ranges::any_of(terms, [&](const SearchedTerm& term) { return term.is(effect); });
}

std::vector<double> unit_values(const SearchedTerm& term) {
    const Effect& effect = *term.kind->effect;
    std::vector<double> values;
    for (const Parameter& parameter : effect.parameters)
        values.push_back(parameter.linear                         ? 1.0
                         : parameter.left_out == LeftOut::assumed ? parameter.start
                                                                  : parameter.neutral);
    for (const auto& [parameter, value] : term.kind->assumed) values[parameter] = value;
    for (std::size_t i = 0; i < term.kind->searched.size(); ++i)
        values[term.kind->searched[i].parameter] = term.values[i];
    return values;
}

std::vector<std::vector<double>> unit_columns(const Effect& effect, std::vector<double> values,
                                              const Situation& situation) {
    // The catalogue's loop holds its direction against noise that a smoothed motion no longer has.
    if (effect.name == "hysteresis")
        return {friction_loop(situation.motion.position_deg, values[*find_parameter(effect, "width_deg")])};
    std::vector<std::vector<double>> columns;
    const auto add = [&] {
        auto& column = columns.emplace_back(situation.motion.size(), 0.0);
        effect.apply(situation, values, column);
    };
    if (effect.polar) {
        values[effect.polar->size] = 1.0;
        for (const double phase_deg : {0.0, -90.0}) {
            values[effect.polar->phase] = phase_deg;
            add();
        }
        return columns;
    }
    for (std::size_t p = 0; p < effect.parameters.size(); ++p) {
        if (!effect.parameters[p].linear) continue;
        for (std::size_t other = 0; other < values.size(); ++other)
            if (effect.parameters[other].linear) values[other] = other == p ? 1.0 : 0.0;
        add();
    }
    return columns;
}

std::vector<std::vector<double>> ripple_factors(const SearchedTerm& term, const Situation& situation) {
    const Effect& effect = *term.kind->effect;
    std::vector<double> values = unit_values(term);
    for (std::size_t p = 0; p < values.size(); ++p)
        if (effect.parameters[p].linear && effect.parameters[p].unit.starts_with('%')) values[p] = 100.0;
    std::vector<double> phases_deg = {0.0};
    if (effect.polar) phases_deg.push_back(-90.0);
    std::vector<std::vector<double>> factors;
    for (const double phase_deg : phases_deg) {
        if (effect.polar) values[effect.polar->phase] = phase_deg;
        std::vector<std::complex<double>> gain(situation.motion.size(), 1.0);
        effect.change_ripple(situation, Order(1.0), values, gain);
        auto& factor = factors.emplace_back(gain.size());
        for (std::size_t k = 0; k < factor.size(); ++k) factor[k] = gain[k].real() - 1.0;
    }
    return factors;
}

Transforms::Transforms(const SearchedTerms& terms) {
    for (const SearchedTerm& term : terms) {
        if (term.kind->role == Role::elastic_joint) elastic_joint.push_back(term);
        if (term.kind->role == Role::sensor) sensor.push_back(term);
    }
}

SearchedTerms Transforms::all() const {
    SearchedTerms terms = elastic_joint;
    terms.insert(terms.end(), sensor.begin(), sensor.end());
    return terms;
}

std::vector<double> transformed(std::vector<double> torque_nm, const SearchedTerms& transforms,
                                const Motion& motion) {
    const Situation situation{.motion = motion, .ratio = GearRatio(0.0)};
    for (const SearchedTerm& term : transforms) {
        std::vector<double> values = unit_values(term);
        for (std::size_t p = 0; p < values.size(); ++p)
            if (term.kind->effect->parameters[p].unit == "Hz")
                values[p] = std::min(values[p], 0.45 * motion.sample_rate.value());
        term.kind->effect->apply(situation, values, torque_nm);
    }
    return torque_nm;
}

MotorAngle motor_angle(const SearchedTerms& terms, GearRatio known) {
    MotorAngle angle{known, {}};
    for (const SearchedTerm& term : terms) {
        if (term.is("gear-ratio"))
            angle.ratio = GearRatio(term.values[0]);
        else if (term.kind->role == Role::motor_angle)
            angle.errors.push_back(term);
    }
    return angle;
}

Motion without_errors(const Motion& motion, const SearchedTerms& errors) {
    Motion corrected = motion;
    GearRatio ratio(0.0);
    for (const SearchedTerm& term : errors)
        term.kind->effect->change_motion(unit_values(term), corrected, ratio);
    return corrected;
}

double width_scale(const TermKind& kind, const SearchedValue& value, const RecordedMotion& recorded) {
    // A step shared with another joint that grew with the speed, up to 28 deg/s, took the viscous friction of
    // the TX40's wrist.
    if (kind.effect->other_joint || (!kind.effect->resists && kind.effect->name != "backlash")) return 1.0;
    const std::string_view unit = kind.effect->parameters[value.parameter].unit;
    return unit == "deg/s" ? recorded.speed_scale() : unit == "deg" ? recorded.angle_scale() : 1.0;
}

std::size_t fitted_values(const SearchedTerm& term, std::size_t ripple_orders) {
    const TermKind& kind = *term.kind;
    switch (kind.role) {
        case Role::ripple_change:
            return kind.effect->polar ? linear_values(*kind.effect) + kind.searched.size()
                                      : 2 * ripple_orders;
        case Role::elastic_joint:
            // The gauges' own ripple, which does not pass the joint, is fitted with it.
            return 2 * ripple_orders + kind.searched.size();
        case Role::joint_torque:
        case Role::sensor_torque:
            return linear_values(*kind.effect) + kind.searched.size();
        case Role::sensor:
        case Role::motor_angle:
            break;
    }
    return kind.searched.size();
}

}  // namespace ripplenotch::engine
