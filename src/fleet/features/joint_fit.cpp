// SPDX-License-Identifier: MIT
#include "fleet/features/motion_facts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/rows/row_facts.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"

namespace ripplenotch {
namespace {

// Less, and the weight of a link is hardly distinguished from a zero error.
constexpr double min_travel_deg = 20.0;
constexpr double width_deg_s = 0.5;          // width of the step of friction where the joint reverses
constexpr std::size_t fewest_samples = 200;  // as recording.fewest_samples of a diagnosis
constexpr std::size_t stretches = 40;        // stretches of the log, for errors that are not white
constexpr double widest_of_value = 0.5;      // an interval's half, of the value ...
constexpr double widest_of_torque = 0.02;    // ... or, in torque, of all torque of the log
constexpr double min_load = 0.1;             // share of inertia and weight in all torque
constexpr std::size_t fewest_reversals = 2;  // a way there and back
constexpr double way_of_start_deg = 1.0;     // chosen, not derived
constexpr double seen_angles = 1.5;          // after a reversal, of the lost motion ...
constexpr std::size_t fewest_in_angle = 8;   // ... in which there are so many samples
constexpr double far_deviations = 10.0;      // in standard deviations: a residual that is no noise
constexpr int linear_iterations = 3, iterations = 15;  // chosen, not derived

FitOptions fit_options(std::size_t samples, int max_iterations) {
    FitOptions options;
    options.max_iterations = max_iterations;
    options.settled = 1e-6;
    options.error_stretch = std::max<std::size_t>(8, samples / stretches);
    return options;
}

}  // namespace

JointFit::JointFit(const FittedSamples& samples, const MotionFacts& facts, std::optional<GearAccount> gear)
    : motion_(samples.motion),
      torque_nm_(samples.torque_nm),
      known_(samples.use),
      facts_(facts),
      gear_(std::move(gear)) {
    if (motion_.size() < fewest_samples)
        raise<DataError>("the log has {} rows; features need at least {}", motion_.size(), fewest_samples);
    const auto known = static_cast<std::size_t>(std::count(known_.begin(), known_.end(), 1));
    if (known < fewest_samples)
        raise<DataError>("the speed jumps: {} of {} rows have a motion that is known, and features need {}",
                         known, motion_.size(), fewest_samples);
    build();
    FitOptions options = fit_options(motion_.size(), linear_iterations);
    options.use = known_;
    options.errors = false;
    fit_ = fit(model_, motion_, torque_nm_, options);
    refine();
}

// Terms that need a first guess of the others: friction that grows with the load, which is the torque of
// inertia and weight, and friction that reverses within an angle (Dahl). Outliers do not count.
void JointFit::refine() {
    Model guess = fit_.model;
    if (facts_.both_directions() && load_rms_nm().value_or(0.0) > min_load * facts_.mix.torque_rms_nm) {
        const std::string friction = fmt::format("load-friction,exponent=1,width_deg_s={}", width_deg_s);
        guess.terms.push_back(parse_term(friction + ",torque_nm=0.01"));
        add_term(friction);
    }
    const std::vector<unsigned char> use = near_samples();
    FitOptions options = fit_options(motion_.size(), iterations);
    options.first_guess = &guess;
    options.use = use;
    const FittedValue* coulomb = fitted("coulomb-friction", "torque_nm");
    if (facts_.mix.reversals < fewest_reversals)
        no_wind_ = fmt::format("{} reversals; {} are needed", facts_.mix.reversals, fewest_reversals);
    else if (!facts_.has_position)
        no_wind_ = "the log has no position";
    else if (coulomb == nullptr || !(coulomb->value > 0.0))
        no_wind_ = "there is no friction whose change of side could be seen";
    else if (winds(coulomb->term, coulomb->value, options))
        return;
    const std::vector<unsigned char> moving = moving_samples(motion_, use, facts_.moving_deg_s);
    if (facts_.both_directions()) options.use = moving;
    options.first_guess = &guess;
    fit_ = fit(model_, motion_, torque_nm_, options);
}

// Uses the fit with presliding friction over an angle, if the log determines the angle.
bool JointFit::winds(std::size_t place, double friction_nm, FitOptions options) {
    Model open = model_, guess = *options.first_guess;
    open.terms[place] = parse_term("hysteresis,initial_state=0");
    guess.terms[place] = parse_term(
        fmt::format("hysteresis,torque_nm={},width_deg=0.1,initial_state=0", shortest(friction_nm)));
    options.first_guess = &guess;
    const Fit wound = fit(open, motion_, torque_nm_, options);
    const auto width = std::find_if(wound.values.begin(), wound.values.end(), [&](const FittedValue& value) {
        return value.term == place &&
               open.terms[place].effect->parameters[value.parameter].name == "width_deg";
    });
    if (width == wound.values.end() || width->at_bound || !width->ci95)
        no_wind_ = "the friction changes side too fast, or the log does not show how";
    else if (width->ci95->high - width->ci95->low > 2.0 * width->value)
        no_wind_ = fmt::format("known to +/- {:.2g} deg only, with a best value of {:.2g}",
                               0.5 * (width->ci95->high - width->ci95->low), width->value);
    if (!no_wind_.empty()) return false;
    const double angle_deg = seen_angles * width->value;
    if (const std::size_t seen = samples_after_reversals(motion_, options.use, angle_deg);
        seen < fewest_in_angle)
        no_wind_ = fmt::format("{} samples of known motion within {:.2g} deg of a reversal; {} are needed",
                               seen, angle_deg, fewest_in_angle);
    model_ = open;
    fit_ = wound;
    return true;
}

std::vector<unsigned char> JointFit::near_samples() const {
    std::vector<double> left = predict_nm(fit_.model, motion_), sizes;
    for (std::size_t k = 0; k < left.size(); ++k) sizes.push_back(std::abs(torque_nm_[k] - left[k]));
    std::vector<double> sorted = sizes;
    const double far = far_deviations * deviations_of_median * median_in(sorted);
    std::vector<unsigned char> use = known_;
    for (std::size_t k = 0; k < use.size(); ++k)
        if (far > 0.0 && sizes[k] > far) use[k] = 0;
    if (facts_.mix.travel_deg >= min_travel_deg) leave_out_start(motion_, way_of_start_deg, use);
    return use;
}

void JointFit::add_term(const std::string& spec) { model_.terms.push_back(parse_term(spec)); }

void JointFit::build() {
    model_.gear_ratio = gear_ ? gear_->ratio : GearRatio(1.0);
    add_term("offset");
    const bool moves = facts_.mix.moving_share > 0.0;
    if (moves && facts_.accelerations.known) add_term("inertia");
    if (facts_.mix.travel_deg >= min_travel_deg) add_term("gravity");
    if (facts_.both_directions()) {
        add_term(fmt::format("coulomb-friction,width_deg_s={}", width_deg_s));
        if (facts_.several_speeds()) add_term("viscous-friction");
    }
    for (const Order order : gear_ ? gear_->orders : std::vector<Order>{})
        add_term(fmt::format("ripple,order={}", shortest(order.value())));
}

const FittedValue* JointFit::fitted(const std::string& effect, const std::string& parameter) const {
    for (std::size_t t = 0; t < model_.terms.size(); ++t) {
        if (model_.terms[t].effect->name != effect) continue;
        const auto place = find_parameter(*model_.terms[t].effect, parameter);
        for (const FittedValue& value : fit_.values)
            if (value.term == t && value.parameter == place) return &value;
        return nullptr;
    }
    return nullptr;
}

void JointFit::estimate(Descriptor& one, const std::string& effect, const std::string& parameter,
                        double carrier, std::string reason) const {
    one.reason = std::move(reason);
    if (!one.reason.empty()) return;
    const FittedValue* value = fitted(effect, parameter);
    if (value == nullptr) {
        one.reason = "the motion of this log does not show it";
    } else if (!value->standard_error || !value->ci95 || !std::isfinite(value->value)) {
        one.reason = "this log does not separate it from the other torques";
    } else if (value->at_bound) {
        one.reason = fmt::format("the best value is {:g}, the least there is", value->value);
    } else {
        const double half = 0.5 * (value->ci95->high - value->ci95->low);
        const double widest = std::max(widest_of_value * std::abs(value->value),
                                       widest_of_torque * facts_.mix.torque_rms_nm / carrier);
        if (!(half <= widest)) {
            one.reason =
                fmt::format("known to +/- {:.2g} only, with a best value of {:.2g}", half, value->value);
        } else {
            one.value = value->value;
            one.ci95 = value->ci95;
        }
    }
}

// Why the joint's motion does not tell friction at all; empty: it does.
std::string JointFit::one_way() const {
    if (!facts_.both_directions()) return "the joint does not move in both directions";
    if (facts_.accelerations.like_friction)
        return "the joint speeds up in one direction only as much as it slows down in the other, where "
               "friction and inertia are collinear";
    return "";
}

// The same of friction at rest in addition to friction that grows with the speed.
std::string JointFit::one_speed() const {
    const std::string reason = one_way();
    if (!reason.empty() || facts_.several_speeds()) return reason;
    return "the joint moves at one speed, where viscous and Coulomb friction are collinear";
}

void JointFit::coulomb_friction(Descriptor& one) const {
    const bool winds = fitted("hysteresis", "torque_nm") != nullptr;
    estimate(one, winds ? "hysteresis" : "coulomb-friction", "torque_nm", std::sqrt(facts_.mix.moving_share),
             one_speed());
}

void JointFit::viscous_friction(Descriptor& one) const {
    estimate(one, "viscous-friction", "coefficient_nm_per_deg_s", facts_.speed_rms_deg_s, one_speed());
}

void JointFit::load_friction(Descriptor& one) const {
    const std::string reason = one_way();
    const bool is_told = fitted("load-friction", "torque_nm") != nullptr || !reason.empty();
    estimate(one, "load-friction", "torque_nm", std::max(load_rms_nm().value_or(0.0), 1e-9),
             is_told ? reason : "the load of the joint is too small against its friction");
}

void JointFit::lost_motion(Descriptor& one) const {
    one.reason = no_wind_;
    const FittedValue* const width = no_wind_.empty() ? fitted("hysteresis", "width_deg") : nullptr;
    if (width == nullptr) return;
    one.value = width->value;
    one.ci95 = width->ci95;
}

void JointFit::inertia(Descriptor& one) const {
    estimate(one, "inertia", "inertia_kgm2", facts_.acceleration_rms_rad_s2, "");
}

void JointFit::gravity(Descriptor& one) const {
    const bool far = facts_.mix.travel_deg >= min_travel_deg;
    estimate(one, "gravity", "amplitude_nm", std::sqrt(0.5),
             far ? ""
                 : fmt::format("the joint travels {:.3g} deg, and a weight needs {:g}", facts_.mix.travel_deg,
                               min_travel_deg));
}

void JointFit::sensor_zero(Descriptor& one) const { estimate(one, "offset", "torque_nm", 1.0, one_way()); }

double JointFit::noise_nm() const {
    std::vector<double> left = predict_nm(fit_.model, motion_);
    for (std::size_t k = 0; k < left.size(); ++k) left[k] = torque_nm_[k] - left[k];
    return noise_from_differences(left, 2);
}

std::optional<double> JointFit::load_rms_nm() const {
    Model load{fit_.model.gear_ratio, {}};
    for (const Term& term : fit_.model.terms)
        if (term.effect->bears_load) load.terms.push_back(term);
    if (load.terms.empty()) return std::nullopt;
    std::vector<double> torque_nm = predict_nm(load, motion_), known_nm;
    for (std::size_t k = 0; k < torque_nm.size(); ++k)
        if (known_[k] != 0) known_nm.push_back(torque_nm[k]);
    const double load_nm = rms(known_nm);
    return std::isfinite(load_nm) ? std::optional(load_nm) : std::nullopt;
}

}  // namespace ripplenotch
