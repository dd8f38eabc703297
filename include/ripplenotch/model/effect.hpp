// SPDX-License-Identifier: MIT
#pragma once
// An effect of the joint or of its sensor is a record of pure functions: one file in src/model/effects, one
// line in effects.def. Law tests run over the whole list.

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "ripplenotch/core/quantity.hpp"
#include "ripplenotch/core/units.hpp"

namespace ripplenotch {

/// The motion that a model is evaluated along: n samples of the joint (output side) at a uniform rate, all
/// four of equal length; sample k is at exactly k / sample_rate.
struct Motion {
    Hertz sample_rate;
    std::vector<double> time_s, position_deg, velocity_deg_s, acceleration_deg_s2;
    [[nodiscard]] std::size_t size() const { return time_s.size(); }
};

/// One number of an effect. Aggregate, so that tables read as data.
struct Parameter {
    std::string_view name;  ///< with its unit: "inertia_kgm2", "amplitude_nm", "phase_deg"
    std::string_view unit;  ///< as units are written on the command line; empty for a plain number
    std::string_view help;
    double neutral =
        0.0;  ///< with every parameter of an effect at its neutral value, the effect changes nothing
    double start = 0.0;               ///< first guess of a search
    double lower = 0.0, upper = 0.0;  ///< both allowed
    bool linear = false;              ///< the effect's output is an affine function of this parameter
};

/// The dimension whose base unit is the parameter's unit, so that values can be typed with any unit of it.
[[nodiscard]] Dimension dimension_of(const Parameter& parameter);

/// True when the value is finite and within the parameter's bounds.
[[nodiscard]] bool allows(const Parameter& parameter, double value);

enum class Side { joint, sensor };  ///< joint effects add torque; sensor effects transform the sum

struct Effect {
    std::string_view name;         ///< kebab-case, stable
    std::string_view summary;      ///< one line
    std::string_view equation;     ///< with the parameters' names, q position in deg, v speed in deg/s
    std::string_view symptom;      ///< what a model without it leaves in the residual
    std::string_view look_alikes;  ///< what leaves nearly the same, and the motion that tells them apart
    std::string_view source;       ///< who described it
    Side side = Side::joint;
    std::span<const Parameter> parameters;
    /// Adds to (joint) or transforms (sensor) `torque_nm`, which has motion.size() entries. `values` has one
    /// entry per parameter, in their order and units, each allowed.
    void (*apply)(const Motion& motion, GearRatio ratio, std::span<const double> values,
                  std::span<double> torque_nm) = nullptr;
};

/// All effects in the order of effects.def.
[[nodiscard]] std::span<const Effect* const> catalogue();

/// Throws UsageError with the nearest name.
[[nodiscard]] const Effect& find_effect(std::string_view name);

/// Place of a parameter in effect.parameters; empty when the effect has none of that name.
[[nodiscard]] std::optional<std::size_t> find_parameter(const Effect& effect, std::string_view name);

}  // namespace ripplenotch
