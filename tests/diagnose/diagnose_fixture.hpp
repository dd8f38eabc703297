// SPDX-License-Identifier: MIT
#pragma once
// Logs with something hidden in them, of a joint that moves in both directions, fast and slow, with rests.

#include <random>
#include <string>
#include <vector>

#include "ripplenotch/core/trace.hpp"
#include "ripplenotch/diagnose/diagnosis.hpp"
#include "ripplenotch/model/motion.hpp"
#include "ripplenotch/model/noise.hpp"

namespace ripplenotch::fixture {

inline constexpr double noise_nm = 0.05;

inline Motion tour_at(Hertz sample_rate) {
    static const std::vector<std::string> specs = {"rest,duration=0.4s",
                                                   "poly6,to=150deg,duration=2.2s",
                                                   "rest,duration=0.4s",
                                                   "poly6,to=-60deg,duration=3s",
                                                   "rest,duration=0.3s",
                                                   "ramp,to-speed=25deg/s,duration=0.2s",
                                                   "constant,speed=25deg/s,duration=1.5s",
                                                   "ramp,to-speed=0deg/s,duration=0.2s",
                                                   "rest,duration=0.3s",
                                                   "ramp,to-speed=-70deg/s,duration=0.4s",
                                                   "constant,speed=-70deg/s,duration=1.5s",
                                                   "ramp,to-speed=0deg/s,duration=0.4s",
                                                   "rest,duration=0.3s",
                                                   "poly6,to=100deg,duration=1.6s",
                                                   "rest,duration=0.4s",
                                                   "poly6,to=-20deg,duration=1.2s",
                                                   "rest,duration=0.4s"};
    return make_motion(specs, sample_rate);
}

inline const Motion& tour() {
    static const Motion motion = tour_at(Hertz(500.0));
    return motion;
}

/// For searches that take long, and for what needs no more samples to be seen: order 2 stays below 110 Hz.
inline const Motion& coarse_tour() {
    static const Motion motion = tour_at(Hertz(250.0));
    return motion;
}

/// Forth and back at several speeds without a rest, three laps: enough blocks of a second.
inline const Motion& strokes() {
    static const Motion motion = [] {
        std::vector<std::string> specs;
        for (int lap = 0; lap < 3; ++lap) {
            for (const char* spec : {"poly6,to=150deg,duration=2.2s", "poly6,to=-60deg,duration=3s",
                                     "poly6,to=100deg,duration=1.6s", "poly6,to=60deg,duration=1.7s",
                                     "poly6,to=90deg,duration=0.9s", "poly6,to=-20deg,duration=1.2s"})
                specs.emplace_back(spec);
        }
        return make_motion(specs, Hertz(500.0));
    }();
    return motion;
}

inline constexpr std::string_view offset = "offset,torque_nm=0.4";
inline constexpr std::string_view viscous = "viscous-friction,coefficient_nm_per_deg_s=0.006";

/// Inertia and two orders of ripple.
inline Model joint() {
    Model model{GearRatio(100.0), {}};
    for (const auto term : {"inertia,inertia_kgm2=0.4", "ripple,order=1,amplitude_nm=0.7,phase_deg=30",
                            "ripple,order=2,amplitude_nm=0.45,phase_deg=-60"}) {
        model.terms.push_back(parse_term(term));
    }
    return model;
}

inline Model model_of(std::initializer_list<const char*> terms) {
    Model model{GearRatio(100.0), {}};
    for (const char* term : terms) model.terms.push_back(parse_term(term));
    return model;
}

inline Model joint_with(std::initializer_list<std::string_view> terms) {
    Model model = joint();
    for (const std::string_view term : terms) model.terms.push_back(parse_term(term));
    return model;
}

/// The same with its numbers left to be fitted.
inline Model opened(Model model) {
    for (Term& term : model.terms) {
        for (std::size_t p = 0; p < term.values.size(); ++p) {
            if (term.effect->parameters[p].left_out != LeftOut::refused) term.values[p].reset();
        }
    }
    return model;
}

inline Trace logged(const Model& truth, const Motion& motion, std::uint64_t seed) {
    std::vector<double> noise(motion.size(), 0.0);
    add_white_noise(noise, noise_nm, seed, NoiseChannel::torque);
    Trace trace{"",
                "",
                motion.sample_rate,
                motion.time_s,
                motion.velocity_deg_s,
                measure_nm(truth, motion, noise),
                motion.position_deg};
    add_white_noise(trace.velocity_deg_s, 0.05, seed, NoiseChannel::velocity);
    return trace;
}

}  // namespace ripplenotch::fixture
