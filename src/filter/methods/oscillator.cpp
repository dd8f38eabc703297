// SPDX-License-Identifier: MIT
// Torque and ripple estimated together by a Kalman filter whose ripple is locked to the motor angle: no
// delay.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <optional>
#include <utility>

#include "filter/map/map_runner.hpp"
#include "filter/map/map_settings.hpp"
#include "filter/method.hpp"
#include "filter/ripple_kalman.hpp"
#include "filter/ripple_keys.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

constexpr double slowest_corrected_turns = 1e-5;  ///< periods of the lowest line in a sample
// Chosen by measurement: docs/methods/oscillator.md.
constexpr double usual_memory_turns = 0.5, memory_turns_beside_map = 0.15;
constexpr double standing_deg_s = 1.0;  ///< a log that begins slower than this begins at standstill

struct Plan {
    RippleOrders ripple;
    RippleModel model;
    std::vector<AmplitudePrior> cold, warm;  ///< in units of the noise; cold where phases cannot be used
    bool has_start = false;
    double start_deg = 0.0;
    std::optional<double> rest_nm;
    bool scheduled = false;
    MotorAngle::Source source = MotorAngle::Source::best;
    bool minus_ripple = false;
    double largest_offset_deg_s = 0.0, largest_slip = 0.0;
    double sample_rate_hz = 0.0;
    double noise_nm = 0.0;
    std::optional<RippleMap> map;  ///< mean of the amplitudes
    bool zero_unknown = false;
    bool knows_phases = false;
    std::optional<MapReach> reach;  ///< speed range of the map
};

void plan_priors(Plan& p, const Settings& settings) {
    const double largest = settings.number("largest") / p.noise_nm;
    p.cold.assign(p.ripple.orders.size(), {0.0, 0.0, largest});
    if (settings.has("phases") && !settings.has("amplitudes")) {
        raise<UsageError>("method oscillator, phases: without amplitudes; give both");
    }
    if (settings.has("amplitudes")) {
        auto amplitudes = per_order("oscillator", settings, "amplitudes", p.ripple, 0.0);
        for (double& amplitude : amplitudes) amplitude = std::max(amplitude / p.noise_nm, 1.0);
        for (std::size_t i = 0; i < amplitudes.size(); ++i) p.cold[i].deviation = amplitudes[i];
        p.warm = p.cold;
        if (settings.has("phases")) {
            const auto phases = per_order("oscillator", settings, "phases", p.ripple, 0.0);
            for (std::size_t i = 0; i < amplitudes.size(); ++i) {
                const double phase = phases[i] * std::numbers::pi / 180.0;
                p.warm[i] = {amplitudes[i] * portable::cos(phase), -amplitudes[i] * portable::sin(phase),
                             settings.number("trust") * amplitudes[i]};
            }
        }
    } else {
        p.warm = p.cold;
    }
}

// With a map, the filter follows the residual of the map; the map's own angle needs no correction.
void plan_map(Plan& p, const Settings& settings) {
    p.map = map_of("oscillator", settings, p.ripple);
    if (!p.map) return;
    const RippleMap& map = *p.map;
    p.zero_unknown = settings.text("zero") == "unknown";
    p.reach.emplace("oscillator", settings, p.ripple.gear_ratio, p.sample_rate_hz);
    p.model.return_turns = settings.number("return");
    if (!settings.has("memory")) p.model.memory_turns = memory_turns_beside_map;
    p.largest_offset_deg_s = p.largest_slip = 0.0;
    for (std::size_t i = 0; i < map.orders.size(); ++i) {
        const double size_nm = largest_amplitude(map, i);
        const double beside_nm = std::max(map.spread_nm[i], settings.number("trust") * size_nm);
        p.warm[i] = {0.0, 0.0, std::max(beside_nm / p.noise_nm, 1.0)};
        p.cold[i] = {0.0, 0.0, std::max(size_nm / p.noise_nm, 1.0)};
    }
}

Plan plan(const Settings& settings, Hertz sample_rate, RippleOrders ripple) {
    Plan p;
    p.ripple = std::move(ripple);
    p.sample_rate_hz = sample_rate.value();
    p.noise_nm = settings.number("noise");
    const double bandwidth_hz = settings.number("bandwidth");
    if (!(bandwidth_hz < 0.25 * p.sample_rate_hz)) {
        raise<UsageError>(
            "method oscillator, bandwidth: {} Hz is not below a quarter of the sample rate, {} Hz",
            shortest(bandwidth_hz), shortest(0.25 * p.sample_rate_hz));
    }
    p.model = {p.ripple.orders, 1.0 / p.sample_rate_hz, 2.0 * std::numbers::pi * bandwidth_hz,
               usual_memory_turns, settings.number("jump")};
    if (settings.has("memory")) p.model.memory_turns = settings.number("memory");
    p.has_start = settings.has("start");
    if (settings.has("rest")) p.rest_nm = settings.number("rest");
    p.scheduled = settings.text("gain") == "scheduled";
    if (p.scheduled && p.model.jump > 0.0)
        raise<UsageError>(
            "method oscillator, jump: needs gain=exact, which knows how far off a sample may be");
    if (p.has_start) p.start_deg = settings.number("start");
    p.source = angle_source(settings);
    p.minus_ripple = settings.text("output") == "minus-ripple";
    p.largest_offset_deg_s = settings.number("offset");
    p.largest_slip = settings.number("slip");
    plan_priors(p, settings);
    plan_map(p, settings);
    p.knows_phases = settings.has("phases");
    p.model.memory_turns /= p.ripple.lowest();
    p.model.return_turns /= p.ripple.lowest();
    return p;
}

class OscillatorFilter final : public CausalFilter {
  public:
    explicit OscillatorFilter(Plan plan)
        : plan_(std::move(plan)),
          angle_(plan_.ripple.gear_ratio, plan_.sample_rate_hz, plan_.source, plan_.start_deg),
          schedule_(plan_.scheduled ? std::make_unique<GainSchedule>(plan_.model) : nullptr),
          cold_(plan_.model, plan_.cold, schedule_.get()),
          warm_(plan_.model, plan_.warm, schedule_.get()) {
        if (plan_.map) mean_.emplace(*plan_.map, plan_.noise_nm);
    }

    void process(const Samples& in, std::span<double> out) override {
        for (std::size_t k = 0; k < out.size(); ++k) {
            const double* const position = in.position_deg.empty() ? nullptr : &in.position_deg[k];
            angle_.next(in.velocity_deg_s[k], position, correction_deg_s_);
            if (plan_.reach) plan_.reach->next(angle_.step_turns());
            const bool tied = position != nullptr || plan_.has_start;
            if (mean_ && !started_) mean_->restart(plan_.zero_unknown || !tied);
            const double mapped_nm = mean_ ? mean_->ripple(in.velocity_deg_s[k], angle_) : 0.0;
            const double beside_nm = in.torque_nm[k] - mapped_nm;
            if (!started_) {
                begin(beside_nm, in.velocity_deg_s[k], tied && !(mean_ && mean_->seeks()));
            } else {
                run((beside_nm - origin_nm_) / plan_.noise_nm);
                if (mean_) mean_->seek(*filter_, angle_);
            }
            const double clean = plan_.minus_ripple ? beside_nm - plan_.noise_nm * filter_->ripple()
                                                    : origin_nm_ + plan_.noise_nm * filter_->torque();
            const double share =
                (waited_ - OscillatorWait::from) / (OscillatorWait::until - OscillatorWait::from);
            out[k] = share < 1.0 ? beside_nm + std::max(share, 0.0) * (clean - beside_nm) : clean;
        }
    }
    void restart() override {
        started_ = false;
        angle_.restart();
        if (plan_.reach) plan_.reach->restart();
    }

  private:
    void begin(double torque_nm, double velocity_deg_s, bool tied) {
        started_ = true;
        correction_deg_s_ = slip_ = slipped_turns_ = 0.0;
        // Phases mean something only where it is known where the joint stands.
        filter_ = tied ? &warm_ : &cold_;
        const bool known = plan_.rest_nm && std::abs(velocity_deg_s) < standing_deg_s;
        origin_nm_ = known ? *plan_.rest_nm : torque_nm;
        waited_ = known || (filter_ == &warm_ && plan_.knows_phases) ? OscillatorWait::until : 0.0;
        if (known) {
            filter_->start_unloaded(angle_.turns(), (torque_nm - origin_nm_) / plan_.noise_nm);
        } else {
            filter_->start(angle_.turns());
        }
    }

    // An angle with a wrong rate turns the phase: the rate estimated from the ripple itself is added to it,
    // slowly compared with the time constant of the amplitudes.
    void run(double measured) {
        const double moved = angle_.step_turns(), step = moved * (1.0 + slip_);
        slipped_turns_ += moved * slip_;
        waited_ += std::abs(step) * plan_.ripple.lowest();
        filter_->next(measured, angle_.turns() + slipped_turns_, step);
        const double share = std::min(std::abs(step) / (4.0 * plan_.model.memory_turns), 0.01);
        const double ahead_turns = share * filter_->phase_advance_turns();
        if (angle_.from_velocity()) {
            const double ahead_deg_s = ahead_turns * 360.0 / plan_.ripple.gear_ratio * plan_.sample_rate_hz;
            const double limit = plan_.largest_offset_deg_s;
            correction_deg_s_ = std::clamp(correction_deg_s_ + ahead_deg_s, -limit, limit);
        } else if (std::abs(step) > slowest_corrected_turns) {
            slip_ = std::clamp(slip_ + ahead_turns / step, -plan_.largest_slip, plan_.largest_slip);
        }
    }

    Plan plan_;
    MotorAngle angle_;
    std::unique_ptr<GainSchedule> schedule_;  ///< null for the exact gain
    RippleKalman cold_, warm_;
    std::optional<MapMean> mean_;
    RippleKalman* filter_ = nullptr;
    double origin_nm_ = 0.0, correction_deg_s_ = 0.0;
    double waited_ = 0.0;                      ///< periods of OscillatorWait
    double slip_ = 0.0, slipped_turns_ = 0.0;  ///< correction of the gear ratio, as a share; its integral
    bool started_ = false;
};

std::unique_ptr<CausalFilter> start(const Settings& settings, Hertz sample_rate, const CandidateTable*) {
    return std::make_unique<OscillatorFilter>(
        plan(settings, sample_rate, counted_orders("oscillator", settings)));
}

FrozenFilter frozen(const Settings& settings, Hertz sample_rate, const CandidateTable*, DegPerSec speed) {
    const Plan p = plan(settings, sample_rate, counted_orders("oscillator", settings));
    const double step_turns = p.ripple.gear_ratio * speed.value() / 360.0 / p.sample_rate_hz;
    std::vector<double> gain(p.model.states());
    if (p.scheduled)
        GainSchedule(p.model).at(step_turns, gain);
    else
        gain = settled_gain(p.model, step_turns);
    const std::string note = step_turns == 0.0 ? "standstill: the ripple's amplitudes keep what they were"
                                               : "settled Kalman filter";
    return {settled_cascade(p.model, step_turns, step_turns == 0.0 ? std::vector<double>{} : gain,
                            p.minus_ripple),
            note, p.source == MotorAngle::Source::velocity || p.largest_slip > 0.0 || p.map.has_value()};
}

RunningDesign running(const Settings& settings, Hertz sample_rate) {
    RippleOrders stated = ripple_orders("oscillator", settings);
    if (!repeats_each_turn(stated.orders)) {
        if (settings.number("second-comb") != 0.0)
            raise<UsageError>(
                "method oscillator as code: a second comb counts by turns of the motor, and not all orders "
                "are whole there");
        stated = stated.by_joint();
    }
    const Plan p = plan(settings, sample_rate, stated);
    const auto refuse = [](bool is, std::string_view what) {
        if (is) raise<UsageError>("method oscillator as code: {} is not written; leave it out", what);
    };
    refuse(p.zero_unknown, "zero=unknown");
    refuse(p.map && settings.number("return") < 1.0, "a return below one period");
    refuse(p.scheduled, "gain=scheduled");
    refuse(p.source == MotorAngle::Source::velocity, "angle=velocity");
    refuse(p.rest_nm.has_value(), "rest");
    OscillatorDesign design{p.ripple.gear_ratio, p.ripple.orders, {}, p.model.step_s, p.noise_nm};
    for (const AmplitudePrior& prior : p.warm)
        design.priors.push_back({prior.cosine, prior.sine, prior.deviation});
    const RippleModel::TorqueNoise noise = p.model.torque_noise();
    design.torque_noise = noise.torque;
    design.cross_noise = noise.cross;
    design.rate_noise = noise.rate;
    design.first_rate_variance = p.model.first_rate_variance();
    design.memory_turns = p.model.memory_turns;
    design.return_turns = p.model.return_turns;
    design.jump = p.model.jump;
    design.largest_slip = p.largest_slip;
    design.waits = !p.knows_phases;
    design.minus_ripple = p.minus_ripple;
    design.map = p.map;
    return design;
}

// Longer and shorter memories, and what is left of a map where there is one.
Trials trials(const TrialConditions& log) {
    Trials found{{{""}, {",output=minus-ripple"}, {",memory=0.15"}, {",memory=2"}, {",gain=scheduled"}}};
    if (log.map.empty()) return found;
    for (const char* const settings : {"", ",output=minus-ripple"})
        found.all.push_back({fmt::format(",map={}{}", log.map, settings)});
    return found;
}

// RippleKalman, with m states: update, gain and prediction; of an order its angle and its phase.
double multiplications(const Settings& settings, const CandidateTable*) {
    const auto orders = static_cast<double>(ripple_orders("oscillator", settings).orders.size()),
               m = 2.0 + 2.0 * orders;
    const double of_states = settings.text("gain") == "scheduled" ? 6.0 * m : 1.5 * m * m + 5.5 * m;
    constexpr double of_order = 14.0 + circle_multiplications, of_sample = 23.0;
    return of_states + orders * of_order + of_sample + map_multiplications(settings);
}

}  // namespace

const Method filter_methods::oscillator = {
    .name = "oscillator",
    .summary = "Kalman filter of torque and ripple, the ripple locked to the motor angle: no delay",
    .source = "R. E. Kalman 1960; harmonic drive ripple so estimated: Taghirad and Belanger 1998",
    .noun = "an oscillator",
    .keys = oscillator_keys,
    .start = start,
    .frozen = frozen,
    .frozen_is_dear = true,  // the solution of a Riccati equation
    .running = running,
    .trials = trials,
    .multiplications = multiplications,
};

}  // namespace ripplenotch
