// SPDX-License-Identifier: MIT
#include "fleet/features/joint_fit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "model/local_motion.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"

namespace ripplenotch {
namespace {

constexpr double least_travel_deg = 20.0;  // less, and the weight of a link is hardly told from a zero error
constexpr double width_deg_s = 0.5;        // of the step of friction where the joint reverses
constexpr double samples_a_period = 3.0;
constexpr std::size_t fewest_samples = 200;
constexpr std::size_t stretches = 40;      // of the log, for errors that are not white
constexpr double widest_of_value = 0.5;    // an interval's half, of the value ...
constexpr double widest_of_torque = 0.02;  // ... or, in torque, of all torque of the log
constexpr double widest_phase_deg = 90.0;  // of its interval, from end to end
constexpr double least_load = 0.1;         // of inertia and weight, of all torque
constexpr int iterations_of_load = 12;
constexpr int iterations_of_lost_motion = 12;

FitOptions fit_options(std::size_t samples, int most_iterations) {
    FitOptions options;
    options.most_iterations = most_iterations;
    options.settled = 1e-6;
    options.error_stretch = std::max<std::size_t>(8, samples / stretches);
    return options;
}

double rms(const std::vector<double>& values) {
    double squares = 0.0;
    for (const double value : values) squares += value * value;
    return std::sqrt(squares / static_cast<double>(std::max<std::size_t>(values.size(), 1)));
}

}  // namespace

/// One value of the fit as a descriptor.
struct JointFit::Wanted {
    std::string stem, unit, effect, parameter;
    double carrier = 1.0;  ///< rms torque in Nm of a value of 1
    std::size_t turn = 0;  ///< which term of that effect
};

JointFit::JointFit(const Motion& motion, std::span<const double> torque_nm, const MotionFacts& facts,
                   std::optional<GearAccount> gear, Hertz rate)
    : motion_(motion), torque_nm_(torque_nm), facts_(facts), gear_(std::move(gear)), rate_(rate) {
    if (motion.size() < fewest_samples)
        raise<DataError>("the log has {} rows; features need at least {}", motion.size(), fewest_samples);
    build();
    fit_ = fit(model_, motion_, torque_nm_, fit_options(motion_.size(), 4));
    // The load that friction grows with is of inertia and weight, which are known by now.
    load_friction_ =
        facts_.both_directions() && load_rms_nm().value_or(0.0) > least_load * facts_.mix.torque_rms_nm;
    if (!load_friction_) return;
    Model guess = fit_.model;
    const std::string friction = fmt::format("load-friction,exponent=1,width_deg_s={}", width_deg_s);
    guess.terms.push_back(parse_term(friction + ",torque_nm=0.01"));
    add_term(friction);
    FitOptions options = fit_options(motion_.size(), iterations_of_load);
    options.first_guess = &guess;
    fit_ = fit(model_, motion_, torque_nm_, options);
}

void JointFit::add_term(const std::string& spec) { model_.terms.push_back(parse_term(spec)); }

void JointFit::build() {
    model_.gear_ratio = gear_ ? gear_->ratio : GearRatio(1.0);
    add_term("offset");
    const bool moves = facts_.mix.moving_share > 0.0;
    if (moves) add_term("inertia");
    if (facts_.mix.travel_deg >= least_travel_deg) add_term("gravity");
    if (facts_.both_directions()) {
        add_term(fmt::format("coulomb-friction,width_deg_s={}", width_deg_s));
        if (facts_.several_speeds()) add_term("viscous-friction");
    }
    if (!gear_ || !moves) return;
    for (const Order order : gear_->orders)
        if (too_fast(order).empty()) add_term(fmt::format("ripple,order={}", shortest(order.value())));
}

std::string JointFit::too_fast(Order order) const {
    const double hz = order.value() * gear_->ratio.value() * facts_.mix.speed_p50_deg_s / 360.0;
    if (hz * samples_a_period <= rate_.value()) return {};
    return fmt::format(
        "at {:.3g} deg/s this line is at {:.3g} Hz, beyond a third of the {:.4g} Hz of the log",
        facts_.mix.speed_p50_deg_s, hz, rate_.value());
}

const FittedValue* JointFit::fitted(const std::string& effect, const std::string& parameter,
                                    std::size_t turn) const {
    for (std::size_t t = 0; t < model_.terms.size(); ++t) {
        if (model_.terms[t].effect->name != effect || turn-- > 0) continue;
        const auto place = find_parameter(*model_.terms[t].effect, parameter);
        for (const FittedValue& value : fit_.values)
            if (value.term == t && value.parameter == place) return &value;
        return nullptr;
    }
    return nullptr;
}

Descriptor JointFit::told(const Wanted& wanted, std::string reason) const {
    Descriptor one{wanted.stem, wanted.unit, {}, {}, std::move(reason)};
    if (!one.reason.empty()) return one;
    const FittedValue* value = fitted(wanted.effect, wanted.parameter, wanted.turn);
    if (value == nullptr) {
        one.reason = "the motion of this log does not show it";
    } else if (!value->standard_error || !value->ci95) {
        one.reason = "this log does not tell it from the other torques";
    } else {
        const double half = 0.5 * (value->ci95->high - value->ci95->low);
        const double widest = std::max(widest_of_value * std::abs(value->value),
                                       widest_of_torque * facts_.mix.torque_rms_nm / wanted.carrier);
        if (!(half <= widest)) {
            one.reason =
                fmt::format("known to +/- {:.2g} only, with a best value of {:.2g}", half, value->value);
        } else {
            one.value = value->value;
            one.ci95 = value->ci95;
        }
    }
    return one;
}

std::vector<Descriptor> JointFit::ripple() const {
    std::vector<Descriptor> all;
    if (!gear_) return all;
    std::size_t turn = 0;
    for (const Order order : gear_->orders) {
        const std::string stem = "ripple_" + shortest(order.value());
        std::string reason = too_fast(order);
        if (reason.empty() && !(facts_.mix.moving_share > 0.0)) reason = "the joint rests";
        const std::size_t here = reason.empty() ? turn++ : turn;
        all.push_back(
            told({stem + "_amplitude", "nm", "ripple", "amplitude_nm", std::sqrt(0.5), here}, reason));
        const bool amplitude = all.back().value.has_value();
        Descriptor phase{stem + "_phase", "deg", {}, {}, reason};
        const FittedValue* value = fitted("ripple", "phase_deg", here);
        const bool sharp = amplitude && value != nullptr && value->ci95 &&
                           value->ci95->high - value->ci95->low < widest_phase_deg;
        if (reason.empty() && !facts_.has_position)
            phase.reason = "the log has no position, and so no angle to count from";
        else if (reason.empty() && !sharp)
            phase.reason = "the amplitude is too small for a phase";
        if (phase.reason.empty()) {
            phase.value = value->value;
            phase.ci95 = value->ci95;
        }
        all.push_back(std::move(phase));
    }
    return all;
}

std::vector<Descriptor> JointFit::torques() const {
    std::string one_way, one_speed;
    if (!facts_.both_directions()) one_way = "the joint does not move in both directions";
    if (one_way.empty() && !facts_.several_speeds())
        one_speed = "the joint moves at one speed, where viscous and Coulomb friction look alike";
    const std::string& friction = one_way.empty() ? one_speed : one_way;
    const std::string short_way = facts_.mix.travel_deg >= least_travel_deg
                                      ? ""
                                      : fmt::format("the joint travels {:.3g} deg, and a weight needs {:g}",
                                                    facts_.mix.travel_deg, least_travel_deg);
    const double moving = std::sqrt(facts_.mix.moving_share);
    const double load_nm = std::max(load_rms_nm().value_or(0.0), 1e-9);
    std::vector<Descriptor> all;
    all.push_back(told({"coulomb_friction", "nm", "coulomb-friction", "torque_nm", moving}, friction));
    all.push_back(told({"viscous_friction", "nm_per_deg_s", "viscous-friction", "coefficient_nm_per_deg_s",
                        facts_.speed_rms_deg_s},
                       friction));
    all.push_back(told(
        {"load_friction", "nm_per_nm", "load-friction", "torque_nm", load_nm},
        load_friction_ || !one_way.empty() ? one_way : "the joint carries too little beside its friction"));
    all.push_back(lost_motion());
    all.push_back(told({"inertia", "kgm2", "inertia", "inertia_kgm2", facts_.acceleration_rms_rad_s2}, ""));
    all.push_back(told({"gravity", "nm", "gravity", "amplitude_nm", std::sqrt(0.5)}, short_way));
    all.push_back(told({"sensor_zero", "nm", "offset", "torque_nm", 1.0}, one_way));
    return all;
}

// Friction that turns over within an angle after each reversal (Dahl) in the place of one that does so at
// once.
Descriptor JointFit::lost_motion() const {
    Descriptor one{"lost_motion", "deg", {}, {}, {}};
    if (facts_.mix.reversals < 2)
        one.reason = fmt::format("{} reversals; two are needed", facts_.mix.reversals);
    else if (!facts_.has_position)
        one.reason = "the log has no position";
    const FittedValue* coulomb = fitted("coulomb-friction", "torque_nm");
    if (one.reason.empty() && (coulomb == nullptr || !(coulomb->value > 0.0)))
        one.reason = "there is no friction whose change of side could be seen";
    if (!one.reason.empty()) return one;
    Model guess = fit_.model, open = fit_.model;
    for (std::size_t t = 0; t < open.terms.size(); ++t) {
        if (open.terms[t].effect->name != "coulomb-friction") continue;
        open.terms[t] = parse_term("hysteresis,initial_state=0");
        guess.terms[t] = parse_term(
            fmt::format("hysteresis,torque_nm={},width_deg=0.1,initial_state=0", shortest(coulomb->value)));
    }
    FitOptions options = fit_options(motion_.size(), iterations_of_lost_motion);
    options.first_guess = &guess;
    const Fit found = fit(open, motion_, torque_nm_, options);
    for (const FittedValue& value : found.values) {
        const Term& term = found.model.terms[value.term];
        if (term.effect->name != "hysteresis" || term.effect->parameters[value.parameter].name != "width_deg")
            continue;
        if (value.at_bound || !value.ci95) {
            one.reason = "the friction changes side too fast, or the log does not show how";
        } else if (value.ci95->high - value.ci95->low > 2.0 * value.value) {
            one.reason = fmt::format("known to +/- {:.2g} deg only, with a best value of {:.2g}",
                                     0.5 * (value.ci95->high - value.ci95->low), value.value);
        } else {
            one.value = value.value;
            one.ci95 = value.ci95;
        }
    }
    return one;
}

double JointFit::noise_nm() const {
    std::vector<double> left = predict_nm(fit_.model, motion_);
    for (std::size_t k = 0; k < left.size(); ++k) left[k] = torque_nm_[k] - left[k];
    return sample_noise(left);
}

std::optional<double> JointFit::load_rms_nm() const {
    Model load{fit_.model.gear_ratio, {}};
    for (const Term& term : fit_.model.terms)
        if (term.effect->bears_load) load.terms.push_back(term);
    if (load.terms.empty()) return std::nullopt;
    return rms(predict_nm(load, motion_));
}

}  // namespace ripplenotch
