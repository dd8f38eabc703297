// SPDX-License-Identifier: MIT
#pragma once
// Pairs of a log and a simulation of it, of random joints, motions and clocks, with effects that the
// simulation lacks.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "ripplenotch/diagnose/setup.hpp"
#include "ripplenotch/model/model.hpp"
#include "ripplenotch/model/motion.hpp"
#include "ripplenotch/model/noise.hpp"

namespace ripplenotch::fixture {

struct PairOptions {
    double delay_s = 0.0;
    double clock_error = 0.0;    ///< the delay grows by so much a second
    bool hides_effects = false;  ///< friction, payload, ripple and more that the simulation lacks
    bool lags = false;           ///< a sensor's lag of up to 8 ms is among them
    bool has_tracking = false;   ///< the controller follows the simulated motion with errors
    double log_rate_hz = 500.0, simulation_rate_hz = 250.0;
};

struct Pair {
    Trace log;
    SimulatedMotion simulation;
    GearRatio gear_ratio{100.0};
    double payload_nm = 0.0;
    std::vector<std::string> hidden;
};

class Dice {
  public:
    explicit Dice(std::uint64_t seed) : noise_(seed, NoiseChannel::spikes) {}
    double between(double low, double high) { return low + (high - low) * noise_.uniform(); }
    bool one_in(double n) { return noise_.uniform() * n < 1.0; }

  private:
    Noise noise_;
};

/// About 22 s, at 2 kHz.
inline Motion random_motion(std::uint64_t seed) {
    Dice dice(seed + 1000);
    std::vector<std::string> specs;
    const int kind = static_cast<int>(dice.between(0.0, 5.0));
    if (kind == 0) {
        specs = {"rest,duration=1.2s"};
        for (int k = 0; k < 9; ++k) {
            specs.push_back(fmt::format("poly6,to={}deg,duration={}s", dice.between(-120.0, 120.0),
                                        dice.between(1.0, 2.8)));
            specs.push_back(fmt::format("rest,duration={}s", dice.between(0.1, 0.5)));
        }
    } else if (kind == 1) {
        specs = {fmt::format("sine,amplitude={}deg,frequency={}Hz,duration=22s", dice.between(30.0, 90.0),
                             dice.between(0.15, 0.5))};
    } else if (kind == 2) {
        specs = {fmt::format("multisine,amplitude={}deg,frequency={}Hz,count=5,duration=22s",
                             dice.between(40.0, 120.0), dice.between(0.05, 0.15))};
    } else if (kind == 3) {
        specs = {"rest,duration=1.2s"};
        for (int k = 0; k < 8; ++k) {
            const double speed = (k % 2 == 0 ? 1.0 : -1.0) * dice.between(15.0, 80.0),
                         ramp = dice.between(0.1, 0.5);
            specs.push_back(fmt::format("ramp,to-speed={}deg/s,duration={}s", speed, ramp));
            specs.push_back(
                fmt::format("constant,speed={}deg/s,duration={}s", speed, dice.between(0.8, 2.0)));
            specs.push_back(fmt::format("ramp,to-speed=0deg/s,duration={}s", ramp));
            specs.push_back(fmt::format("rest,duration={}s", dice.between(0.1, 0.4)));
        }
    } else {
        specs = {fmt::format("sweep,amplitude={}deg,from-frequency=0.1Hz,to-frequency={}Hz,duration=22s",
                             dice.between(20.0, 45.0), dice.between(0.8, 1.6))};
    }
    specs.insert(specs.begin(), "rest,duration=0.5s,from=" + fmt::format("{}deg", dice.between(-90.0, 90.0)));
    return make_motion(specs, Hertz(2000.0));
}

/// A value of a series of the fine motion, linear between its samples.
inline double fine_at(const std::vector<double>& values, double at_s) {
    const double place = std::clamp(at_s * 2000.0, 0.0, static_cast<double>(values.size() - 2));
    const auto k = static_cast<std::size_t>(place);
    const double share = place - static_cast<double>(k);
    return (1.0 - share) * values[k] + share * values[k + 1];
}

inline Pair random_pair(std::uint64_t seed, const PairOptions& options) {
    Dice dice(seed);
    Pair pair;
    pair.gear_ratio = GearRatio(dice.one_in(2.0) ? 100.0 : dice.between(30.0, 160.0));
    const Motion motion = random_motion(seed);
    Model simulated{pair.gear_ratio, {}}, real{pair.gear_ratio, {}};
    const auto both = [&](const std::string& term) {
        simulated.terms.push_back(parse_term(term));
        real.terms.push_back(parse_term(term));
    };
    const auto hide = [&](const std::string& term) {
        real.terms.push_back(parse_term(term));
        pair.hidden.push_back(term);
    };
    const bool hides = options.hides_effects;
    const double inertia = dice.between(0.2, 1.5), gravity = dice.one_in(4.0) ? 0.0 : dice.between(3.0, 40.0);
    // An inertia or a payload that the simulation has too much or too little of.
    const double real_inertia = hides && dice.one_in(3.0) ? inertia * dice.between(0.7, 1.4) : inertia;
    const double real_gravity = hides && dice.one_in(3.0) ? gravity * dice.between(0.7, 1.4) : gravity;
    const double phase = dice.between(-180.0, 180.0);
    for (auto [model, j, g] :
         {std::tuple(&simulated, inertia, gravity), std::tuple(&real, real_inertia, real_gravity)}) {
        model->terms.push_back(parse_term(fmt::format("inertia,inertia_kgm2={}", j)));
        if (g > 0.0)
            model->terms.push_back(parse_term(fmt::format("gravity,amplitude_nm={},phase_deg={}", g, phase)));
    }
    pair.payload_nm = gravity;
    if (dice.one_in(2.0))
        both(fmt::format("coulomb-friction,torque_nm={},width_deg_s=1", dice.between(0.2, 2.0)));
    if (dice.one_in(2.0))
        both(fmt::format("ripple,order=2,amplitude_nm={},phase_deg=40", dice.between(0.1, 1.0)));
    if (hides) {
        if (dice.one_in(2.0))
            hide(fmt::format("coulomb-friction,torque_nm={},width_deg_s={}", dice.between(0.2, 3.0),
                             dice.between(0.5, 6.0)));
        if (dice.one_in(2.0))
            hide(fmt::format("viscous-friction,coefficient_nm_per_deg_s={}", dice.between(0.003, 0.05)));
        if (dice.one_in(3.0))
            hide(fmt::format("stribeck-friction,torque_nm={},stribeck_speed_deg_s=6,width_deg_s=1",
                             dice.between(0.2, 1.5)));
        if (dice.one_in(3.0))
            hide(fmt::format("ripple,order=1,amplitude_nm={},phase_deg=70", dice.between(0.1, 1.5)));
        if (dice.one_in(4.0))
            hide(fmt::format("hysteresis,torque_nm={},width_deg=2,initial_state=0", dice.between(0.2, 1.5)));
        if (dice.one_in(4.0))
            hide(fmt::format("output-ripple,order=1,amplitude_nm={},phase_deg=10", dice.between(0.2, 2.0)));
        if (dice.one_in(4.0))
            hide(
                fmt::format("load-friction,torque_nm={},exponent=1,width_deg_s=1", dice.between(0.02, 0.15)));
        if (dice.one_in(3.0)) hide(fmt::format("offset,torque_nm={}", dice.between(-2.0, 2.0)));
        if (dice.one_in(4.0))
            hide(fmt::format("drift,rate_nm_s={},time_constant_s=1000", dice.between(-0.03, 0.03)));
        if (dice.one_in(5.0))
            hide(fmt::format("tone,frequency_hz=50,amplitude_nm={},phase_deg=0", dice.between(0.1, 0.6)));
        if (options.lags && dice.one_in(3.0))
            hide(fmt::format("lag,time_constant_s={}", dice.between(0.001, 0.008)));
    }
    const double scale = hides && dice.one_in(3.0) ? dice.between(0.8, 1.3) : 1.0;
    std::vector<double> measured = predict_nm(real, motion), expected = predict_nm(simulated, motion);
    for (double& each : expected) each /= scale;
    const double span_s = motion.time_s.back();
    // The simulation moves as commanded; the joint as its controller lets it.
    const double slow = options.has_tracking ? 1.0 - dice.between(0.0, 0.05) : 1.0;
    Trace& log = pair.log;
    log.sample_rate = Hertz(options.log_rate_hz);
    const double torque_noise_nm = dice.between(0.02, 0.2), middle_s = 0.5 * span_s;
    for (double t = 1.0; t < span_s - 1.0; t += 1.0 / options.log_rate_hz) {
        const double at_s = t - options.delay_s - options.clock_error * (t - middle_s);
        log.time_s.push_back(t);
        log.position_deg.push_back(slow * fine_at(motion.position_deg, at_s));
        log.velocity_deg_s.push_back(slow * fine_at(motion.velocity_deg_s, at_s));
        log.torque_nm.push_back(fine_at(measured, at_s));
    }
    add_white_noise(log.torque_nm, torque_noise_nm, seed, NoiseChannel::torque);
    add_white_noise(log.velocity_deg_s, dice.between(0.02, 0.3), seed, NoiseChannel::velocity);
    const double step_deg = dice.one_in(2.0) ? 360.0 / 65536.0 : 360.0 / 1048576.0;
    for (double& each : log.position_deg) each = step_deg * std::round(each / step_deg);
    if (options.has_tracking)
        add_noise(log.position_deg, {dice.between(0.01, 0.2), 0.995}, seed + 7, NoiseChannel::spikes);
    SimulatedMotion& simulation = pair.simulation;
    for (double t = 0.5; t < span_s - 0.2; t += 1.0 / options.simulation_rate_hz) {
        simulation.time_s.push_back(t);
        simulation.position_deg.push_back(fine_at(motion.position_deg, t));
        simulation.velocity_deg_s.push_back(fine_at(motion.velocity_deg_s, t));
        simulation.torque_nm.push_back(fine_at(expected, t));
    }
    return pair;
}

}  // namespace ripplenotch::fixture
