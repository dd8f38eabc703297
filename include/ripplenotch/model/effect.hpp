// SPDX-License-Identifier: MIT
#pragma once
// An effect of the joint or of its sensor is a record of pure functions: one file in src/model/effects, one line in
// effects.def. Law tests run over the whole list.

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "ripplenotch/core/quantity.hpp"
#include "ripplenotch/core/units.hpp"

namespace ripplenotch {

/// The motion that a model is evaluated along: n samples at a uniform rate, in degrees, seconds.
struct Motion {
    Hertz sample_rate;
    GearRatio gear_ratio;
    std::vector<double> time_s, position_deg, velocity_deg_s, acceleration_deg_s2;
    [[nodiscard]] std::size_t size() const { return time_s.size(); }
};

struct Parameter {
    std::string_view name;          ///< with its unit: "inertia_kgm2", "amplitude_nm", "phase_deg"
    std::string_view unit;
    std::string_view help;
    double neutral = 0.0;           ///< value at which the effect changes nothing
    double start = 0.0;             ///< first guess of a search
    double lower = 0.0, upper = 0.0;
    bool linear = false;            ///< output is linear in this parameter
};

enum class Side { joint, sensor };  ///< joint effects add torque; sensor effects transform the sum

struct Effect {
    std::string_view name;          ///< kebab-case, stable
    std::string_view summary, equation, symptom, source;
    Side side = Side::joint;
    std::span<const Parameter> parameters;
    /// Adds to (joint) or transforms (sensor) `torque_nm`, which has motion.size() entries. `values` as parameters.
    void (*apply)(const Motion& motion, std::span<const double> values, std::span<double> torque_nm) = nullptr;
};

/// All effects in the order of effects.def.
[[nodiscard]] std::span<const Effect* const> catalogue();
/// Throws UsageError with the nearest name.
[[nodiscard]] const Effect& find_effect(std::string_view name);

}  // namespace ripplenotch
