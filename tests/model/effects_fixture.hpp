// SPDX-License-Identifier: MIT
#pragma once
// What tests of many effects share: a motion and a model in which every effect has something to act on.

#include <algorithm>
#include <cmath>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "ripplenotch/core/portable_math.hpp"
#include "ripplenotch/model/model.hpp"
#include "ripplenotch/model/motion.hpp"

namespace ripplenotch::fixture {

/// Rest, both directions, slow and fast, reversals.
inline const Motion& rich_motion() {
    static const std::vector<std::string> specs = {
        "rest,duration=0.3s,from=20deg", "poly6,to=-70deg,duration=1s", "rest,duration=0.2s",
        "ramp,to-speed=100deg/s,duration=0.5s",
        "sine,amplitude=30deg,frequency=0.8Hz,duration=1.5s,phase=0deg"};
    static const Motion motion = [] {
        Motion made = make_motion(specs, Hertz(500.0));
        // Another joint of an arm, which turns all the time.
        made.others_deg_s.emplace_back();
        for (const double t : made.time_s)
            made.others_deg_s.back().push_back(40.0 * portable::sin_degrees(400.0 * t + 20.0));
        // What a simulation may know of the joint.
        for (const double t : made.time_s)
            made.known_nm.push_back(0.3 + 0.8 * portable::sin_degrees(290.0 * t));
        return made;
    }();
    return motion;
}

inline Motion first_part(const Motion& motion, std::size_t count) {
    Motion part = motion;
    for (auto* column : {&part.time_s, &part.position_deg, &part.velocity_deg_s, &part.acceleration_deg_s2,
                         &part.known_nm}) {
        column->resize(count);
    }
    for (auto& column : part.others_deg_s) column.resize(count);
    return part;
}

/// Load, and ripple of two orders.
inline Model base_model() {
    Model model{GearRatio(100.0), {}};
    for (const auto term :
         {"inertia,inertia_kgm2=0.8", "gravity,amplitude_nm=1.5,phase_deg=20",
          "ripple,order=1,amplitude_nm=0.7,phase_deg=30", "ripple,order=2,amplitude_nm=0.4,phase_deg=-50"}) {
        model.terms.push_back(parse_term(term));
    }
    return model;
}

inline Model with(Model model, const Effect& effect, const std::vector<double>& values) {
    model.terms.push_back({&effect, {values.begin(), values.end()}});
    return model;
}

inline std::vector<double> neutral_values(const Effect& effect) {
    std::vector<double> values;
    for (const Parameter& parameter : effect.parameters) values.push_back(parameter.neutral);
    return values;
}

/// First guesses; where those are neutral, a value that is not.
inline std::vector<double> active_values(const Effect& effect) {
    std::vector<double> values;
    for (const Parameter& p : effect.parameters)
        values.push_back(p.start == p.neutral && p.linear ? p.neutral + 1.0 : p.start);
    return values;
}

/// Within the bounds, and within a factor of ten of the first guess: where fits take place. What a fit does
/// not search for stays as it is.
inline std::vector<double> random_values(const Effect& effect, std::mt19937_64& engine) {
    std::vector<double> values;
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    for (const Parameter& parameter : effect.parameters) {
        const double reach = 10.0 * std::max(std::abs(parameter.start), 1e-2);
        const double low = std::max(parameter.lower, -reach), high = std::min(parameter.upper, reach);
        const double part = unit(engine);
        values.push_back(parameter.left_out == LeftOut::fitted ? low + (high - low) * part : parameter.start);
    }
    return values;
}

inline double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
    double most = 0.0;
    for (std::size_t k = 0; k < std::min(a.size(), b.size()); ++k)
        most = std::max(most, std::abs(a[k] - b[k]));
    return most;
}

inline Model model_of(std::initializer_list<std::string_view> terms) {
    Model model{GearRatio(100.0), {}};
    for (const auto term : terms) model.terms.push_back(parse_term(term));
    return model;
}

}  // namespace ripplenotch::fixture
