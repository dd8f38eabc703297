// SPDX-License-Identifier: MIT
#include "diagnose/engine/baseline.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/functions/many_numbers.hpp"
#include "core/vectors/dot.hpp"
#include "diagnose/engine/gram.hpp"
#include "diagnose/engine/terms.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch::engine {
namespace {

constexpr double friction_step_deg_s = 0.5;
// Widths of a known Coulomb friction: its step over speed, and loops over the angle, because a stated
// friction holds at standstill and how softly is not stated.
constexpr double known_step_deg_s = 0.3;
constexpr std::array known_loops_deg = {0.03, 0.12};
// What the smoothing and the elasticity of a gear make of the inertia's torque, in shares of the inertia: its
// first derivative in s and its second in s^2.
constexpr double jerk_share_s = 0.005, snap_share_s2 = 3e-5;
constexpr double known_scale_deviation = 0.02;  // a torque constant is known to two per cent
// Of the sizes of friction that a model states, and of the gravity of a simulation of unknown scale.
constexpr double known_deviation = 0.04;
// Of inertia and gravity in a simulation of known scale: its author knows the masses.
constexpr double known_mass_deviation = 0.01;
constexpr double fixed_share = 1e-6;  // of a value that is stated: its column stays for the load's sake
constexpr double least_gravity_nm = 1e-4;
constexpr double no_inertia_nm_per_deg_s2 = 1e-9;  // far below that of any joint

std::vector<double> step_of_direction(const Motion& motion, double width_deg_s) {
    std::vector<double> step(motion.size());
    for (std::size_t k = 0; k < step.size(); ++k) step[k] = motion.velocity_deg_s[k] / width_deg_s;
    portable::tanh(step, step);
    return step;
}

std::vector<std::vector<double>> cosine_and_sine(const std::vector<double>& angle_deg) {
    std::vector<std::vector<double>> columns(2, std::vector<double>(angle_deg.size()));
    portable::cos_degrees(angle_deg, columns[0]);
    portable::sin_degrees(angle_deg, columns[1]);
    return columns;
}

// Columns of a term of the user's model: its linear values are free, the others as stated or at their start.
std::vector<std::vector<double>> term_columns(const Term& term, const Situation& situation) {
    std::vector<double> values;
    for (std::size_t p = 0; p < term.values.size(); ++p) {
        const Parameter& parameter = term.effect->parameters[p];
        const bool is_step = term.effect->name == "coulomb-friction" && parameter.name == "width_deg_s";
        values.push_back(term.values[p].value_or(is_step ? known_step_deg_s : parameter.start));
    }
    return unit_columns(*term.effect, values, situation);
}

// Size of the linear values of a term with all values stated; 0 where one is free.
double stated_size(const Term& term) {
    double size = 0.0;
    for (std::size_t p = 0; p < term.values.size(); ++p) {
        if (!term.values[p]) return 0.0;
        if (term.effect->parameters[p].linear) size = std::max(size, std::abs(*term.values[p]));
    }
    return size;
}

std::optional<std::vector<double>> all_stated(const Term& term) {
    std::vector<double> values;
    for (std::size_t p = 0; p < term.values.size(); ++p) {
        const Parameter& parameter = term.effect->parameters[p];
        if (!term.values[p] && parameter.left_out != LeftOut::assumed) return std::nullopt;
        values.push_back(term.values[p].value_or(parameter.start));
    }
    return values;
}

// What a model states of its sensors, its elastic joint, its position and its ripple.
void add_stated(Baseline& base, const Model& model, const Situation& situation) {
    for (const Term& term : model.terms) {
        const auto kind =
            std::ranges::find_if(term_kinds(), [&](const TermKind& k) { return k.effect == term.effect; });
        const auto values = all_stated(term);
        if (kind == term_kinds().end() || !values) continue;
        if (kind->role == Role::ripple_change && !term.effect->uses_load) {
            base.ripple_gain.resize(base.orders.size(),
                                    std::vector<std::complex<double>>(situation.motion.size(), 1.0));
            for (std::size_t i = 0; i < base.orders.size(); ++i)
                term.effect->change_ripple(situation, Order(base.orders[i]), *values, base.ripple_gain[i]);
        }
        if (kind->effect->name == "gear-ratio")
            base.ratio = GearRatio(base.ratio.value() * (1.0 + 0.01 * values->front()));
        else if (kind->role == Role::sensor || kind->role == Role::elastic_joint ||
                 kind->role == Role::motor_angle) {
            SearchedTerm& stated = base.stated.emplace_back(SearchedTerm{&*kind, {}});
            for (std::size_t i = 0; i < kind->searched.size(); ++i)
                stated.values[i] = (*values)[kind->searched[i].parameter];
        }
    }
}

// Inertia in Nm/(deg/s2) and size of the gravity in a torque, by its regression on the motion.
std::pair<double, double> inertia_and_gravity_of(const std::vector<double>& torque_nm,
                                                 const RecordedMotion& recorded,
                                                 const std::vector<double>& direction) {
    const Motion& motion = recorded.motion();
    std::vector<std::vector<double>> columns = {motion.acceleration_deg_s2,
                                                std::vector<double>(motion.size(), 1.0), direction,
                                                motion.velocity_deg_s};
    for (auto& column : cosine_and_sine(motion.position_deg)) columns.push_back(std::move(column));
    const std::vector<double> factors = regress(columns, torque_nm, recorded.usable());
    return {factors[0], portable::hypot(factors[4], factors[5])};
}

}  // namespace

bool Baseline::has(std::string_view name) const {
    return std::ranges::any_of(
        columns, [&](const BaseColumn& column) { return column.name == name && !column.has_prior(); });
}

bool Baseline::is_known(std::string_view name) const {
    return states(name) || (is_simulated && (name == "gravity" || name == "simulation-scale"));
}

bool Baseline::states(std::string_view name) const {
    return std::ranges::any_of(
        columns, [&](const BaseColumn& column) { return column.name == name && column.has_prior(); });
}

std::vector<std::vector<double>> ripple_columns(const Motion& motion, std::span<const double> orders,
                                                GearRatio ratio) {
    std::vector<std::vector<double>> columns;
    std::vector<double> angle_deg(motion.size());
    for (const double order : orders) {
        for (std::size_t k = 0; k < angle_deg.size(); ++k)
            angle_deg[k] = order * ratio.value() * motion.position_deg[k];
        for (auto& column : cosine_and_sine(angle_deg)) columns.push_back(std::move(column));
    }
    return columns;
}

std::vector<std::vector<double>> Baseline::ripple_waves(const Motion& motion, GearRatio at) const {
    auto waves = ripple_columns(motion, orders, at);
    for (std::size_t i = 0; i < ripple_gain.size(); ++i) {
        for (std::size_t k = 0; k < motion.size(); ++k) {
            const std::complex<double> wave(waves[2 * i][k], waves[2 * i + 1][k]);
            const std::complex<double> changed = ripple_gain[i][k] * wave;
            waves[2 * i][k] = changed.real();
            waves[2 * i + 1][k] = changed.imag();
        }
    }
    return waves;
}

Baseline make_baseline(const RecordedMotion& recorded, const KnownSide& known,
                       std::optional<double> inertia_nm_per_deg_s2) {
    const Motion& motion = recorded.motion();
    const Situation situation{.motion = motion, .ratio = known.model->gear_ratio};
    Baseline base;
    base.ratio = known.model->gear_ratio;
    base.is_simulated = known.is_simulated;
    base.direction = step_of_direction(motion, friction_step_deg_s * recorded.speed_scale());
    for (const Term& term : known.model->terms)
        if (term.effect->ripple_order) base.orders.push_back(term.values[*term.effect->ripple_order].value());
    add_stated(base, *known.model, situation);
    if (known.is_simulated && !known.is_scale_known)
        base.columns.push_back({.name = "simulated", .torque_nm = motion.known_nm, .bears_load = true});
    base.inertia_place = base.columns.size();
    base.columns.push_back({.name = "inertia", .torque_nm = motion.acceleration_deg_s2, .bears_load = true});
    const auto add_known = [&](double factor, const std::vector<double>& column) {
        base.known_nm.resize(motion.size(), 0.0);
        add_scaled(factor, column.data(), base.known_nm.data(), column.size());
    };
    if (!known.is_simulated) {
        for (const Term& term : known.model->terms) {
            const Effect& effect = *term.effect;
            if (effect.name == "inertia" && term.values[0]) {
                const double stated = *term.values[0] / degrees_per_radian;
                add_known(stated, motion.acceleration_deg_s2);
                base.known_inertia_nm_per_deg_s2 = stated;
                base.columns[base.inertia_place].deviation = fixed_share * std::abs(stated);
            }
            if (effect.side != Side::joint || effect.ripple_order || effect.uses_load ||
                effect.name == "inertia")
                continue;
            if (const double size_nm = stated_size(term); size_nm > 0.0) {
                std::vector<double> values, torque(motion.size(), 0.0);
                for (const auto& value : term.values) values.push_back(*value);
                effect.apply(situation, values, torque);
                add_known(1.0, torque);
                if (effect.bears_load) continue;  // a mass that is stated is fixed
                for (auto& column : term_columns(term, situation))
                    base.columns.push_back({.name = std::string(effect.name),
                                            .torque_nm = std::move(column),
                                            .deviation = known_deviation * size_nm});
                if (effect.name != "coulomb-friction") continue;
                // How softly it turns over is not stated, which changes its form and not its size.
                for (const double width_deg : known_loops_deg) {
                    auto loop = friction_loop(motion.position_deg, width_deg * recorded.angle_scale());
                    add_scaled(-1.0 / size_nm, torque.data(), loop.data(), loop.size());
                    base.columns.push_back(
                        {.name = "nuisance", .torque_nm = std::move(loop), .deviation = size_nm});
                }
                continue;
            }
            for (auto& column : term_columns(term, situation))
                base.columns.push_back({.name = std::string(effect.name),
                                        .torque_nm = std::move(column),
                                        .bears_load = effect.bears_load});
        }
    }
    if (base.has("coulomb-friction")) {
        for (const double width_deg : known_loops_deg)
            base.columns.push_back(
                {.name = "nuisance",
                 .torque_nm = friction_loop(motion.position_deg, width_deg * recorded.angle_scale())});
    }
    if (known.is_simulated && known.is_scale_known) {
        base.known_nm = motion.known_nm;
        base.is_scale_known = true;
        base.columns.push_back(
            {.name = "nuisance", .torque_nm = motion.known_nm, .deviation = known_scale_deviation});
    }
    if (known.is_simulated) {
        const auto [inertia, gravity_nm] = inertia_and_gravity_of(motion.known_nm, recorded, base.direction);
        base.simulated_inertia_nm_per_deg_s2 = inertia;
        if (known.is_scale_known) {
            base.columns[base.inertia_place].deviation = known_mass_deviation * std::abs(inertia);
            base.known_inertia_nm_per_deg_s2 = inertia;
        } else if (inertia_nm_per_deg_s2) {
            *inertia_nm_per_deg_s2 += inertia;  // that is what the simulation lacks
        }
        const double mass_deviation = known.is_scale_known ? known_mass_deviation : known_deviation;
        for (auto& column : cosine_and_sine(motion.position_deg))
            base.columns.push_back({.name = "nuisance",
                                    .torque_nm = std::move(column),
                                    .deviation = mass_deviation * gravity_nm + least_gravity_nm});
    }
    const auto share = [&](double of) {
        return inertia_nm_per_deg_s2 ? std::abs(*inertia_nm_per_deg_s2) * of
                                     : std::numeric_limits<double>::infinity();
    };
    std::vector<double> jerk = gradient(motion.acceleration_deg_s2, recorded.step_s());
    std::vector<double> snap = gradient(jerk, recorded.step_s());
    base.columns.push_back(
        {.name = "nuisance", .torque_nm = std::move(jerk), .deviation = share(jerk_share_s)});
    base.columns.push_back(
        {.name = "nuisance", .torque_nm = std::move(snap), .deviation = share(snap_share_s2)});
    for (const GivenTerm& given : known.given_terms) {
        // Its columns hold the inertia of this joint.
        if (given.name == "arm") base.columns[base.inertia_place].deviation = no_inertia_nm_per_deg_s2;
        for (std::size_t value = 0; value < given.torque_nm.size(); ++value) {
            std::vector<double> column = recorded.on_clock(given.torque_nm[value]);
            if (given.mean[value] != 0.0) add_known(given.mean[value], column);
            if (given.deviation[value] > stated_deviation)
                base.columns.push_back({.name = given.name,
                                        .torque_nm = std::move(column),
                                        .deviation = given.deviation[value],
                                        .bears_load = true});
        }
    }
    return base;
}

}  // namespace ripplenotch::engine
