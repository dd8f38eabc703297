// SPDX-License-Identifier: MIT
#pragma once
// An effect of the joint or of its sensor is a record of pure functions, beside its family in
// src/model/effects, and one line in effects.def. Law tests run over the whole list.

#include <complex>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "ripplenotch/core/quantity.hpp"

namespace ripplenotch {

/// The motion that a model is evaluated along: n samples of the joint (output side), all four of equal
/// length. Made by make_motion, sample k is at exactly k / sample_rate; measured in a log, times are the
/// log's own and sample_rate is their mean rate, which effects with a memory take for every step.
struct Motion {
    Hertz sample_rate;
    std::vector<double> time_s, position_deg, velocity_deg_s, acceleration_deg_s2;
    /// Torque at the joint that is known besides the model's effects: of the user's simulation, of an arm's
    /// rigid bodies. The sensor's effects act on it, and gear and bearings carry it. size() entries, or none.
    std::vector<double> known_nm = {};
    /// Velocities of the arm's joints in the order of its chain, size() entries each; empty for this joint.
    /// None where no arm is known.
    std::vector<std::vector<double>> others_deg_s = {};
    [[nodiscard]] std::size_t size() const { return time_s.size(); }
};

/// How a parameter is treated that a model leaves out.
enum class LeftOut {
    fitted,   ///< it is estimated from a log; until then the model cannot be simulated
    refused,  ///< it names the line, and a fit does not search for lines: it must be stated
    assumed,  ///< `start` is assumed: a log hardly determines it
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
    bool linear = false;              ///< the torque is an affine function of this parameter
    bool logarithmic = false;         ///< a search moves in its logarithm; lower is above 0
    LeftOut left_out = LeftOut::fitted;
    std::vector<double> tried = {};  ///< where a search begins; `start` when there are none
};

/// The dimension whose base unit is the parameter's unit, so that values can be typed with any unit of it.
[[nodiscard]] Dimension dimension_of(const Parameter& parameter);

/// True when the value is finite and within the parameter's bounds.
[[nodiscard]] bool allows(const Parameter& parameter, double value);

/// Where an effect acts. A model is evaluated in this order; within one side, in the order of the model.
enum class Side {
    motion,     ///< changes the motion or the gear ratio that everything after it sees
    ripple,     ///< changes size and phase of the model's ripple terms
    joint,      ///< adds torque
    sensor,     ///< transforms the sum, as a continuous signal; noise is added after it
    converter,  ///< transforms the logged torque, noise included
};
[[nodiscard]] std::string_view side_name(Side side);

/// The main variable of an effect's torque: where it is searched for, and what can pass for it.
enum class Domain { time, position, speed, order, frequency };

/// Another cause that leaves nearly the same residual, and how the two are distinguished.
struct LookAlike {
    std::string_view name;     ///< name of an effect; or a description, when it is not in the catalogue
    std::string_view when;     ///< the logs in which they are hard to distinguish
    std::string_view told_by;  ///< the experiment that would decide
};

/// Inputs of an effect besides its own values. Spans have motion.size() entries, or none.
struct Situation {
    const Motion& motion;
    GearRatio ratio;
    std::span<const double> load_nm = {};  ///< torque of the effects that bear load; for those that use it
    /// Gain of the current term; empty: 1 everywhere.
    std::span<const std::complex<double>> ripple_gain = {};
};

/// The two parameters, in polar form, whose Cartesian form (size * cos phase, size * sin phase) the torque is
/// linear in.
struct Polar {
    std::size_t size, phase;  ///< places in Effect::parameters
};

struct LoggedTorque;   // below
struct DetectedFault;  // below

struct Effect {
    std::string_view name;      ///< kebab-case, stable
    std::string_view summary;   ///< one line
    std::string_view equation;  ///< with the parameters' names, q position in deg, v speed in deg/s
    std::string_view symptom;   ///< the residual of a model without it
    std::vector<LookAlike> look_alikes;
    std::string_view source;  ///< who described it
    Side side = Side::joint;
    Domain domain = Domain::time;
    std::vector<Parameter> parameters;
    std::optional<Polar> polar = std::nullopt;
    bool bears_load = false;  ///< joint: its torque is part of the load that gear and bearings carry
    bool uses_load = false;   ///< it uses Situation::load_nm
    bool resists = false;     ///< joint: a friction, whose first parameter is its size; below 0 it drives
    bool differs = false;     ///< joint: in one direction it is another effect's torque, and is not tried
    bool chance = false;      ///< converter: which samples it hits is chance, so that no prediction holds it
    bool linear_in_torque = true;  ///< sensor, converter: acts on a sum as the sum of its actions
    std::optional<std::size_t> ripple_order = std::nullopt;  ///< joint: it is a ripple term, and this
                                                             ///< parameter is its order
    /// joint: this parameter is the place, from 1, of another joint of the arm on whose motion it depends
    std::optional<std::size_t> other_joint = std::nullopt;
    /// ripple: from 0.5 on this parameter lets it act on the whole torque, as a sensor's effect does and by
    /// `apply`; see side_of(term)
    std::optional<std::size_t> whole = std::nullopt;
    /// converter: detectors of a lower turn have marked the samples that they invalidate before this one runs
    std::size_t detect_turn = 0;

    // One of the following, by side. `values` has one entry per parameter, in their order and units, each
    // allowed. All are pure functions.

    /// joint: adds to `torque_nm`; sensor, converter, and what may act on the whole torque: transforms it. It
    /// has motion.size() entries.
    void (*apply)(const Situation& situation, std::span<const double> values,
                  std::span<double> torque_nm) = nullptr;
    /// motion, and what may act on the whole torque: which motion the joint's torques see
    void (*change_motion)(std::span<const double> values, Motion& motion, GearRatio& ratio) = nullptr;
    /// ripple: multiplies the complex gain of a ripple term of the order given; its torque is
    /// amplitude * Re(gain * exp(i * angle)).
    void (*change_ripple)(const Situation& situation, Order order, std::span<const double> values,
                          std::span<std::complex<double>> gain) = nullptr;

    /// converter, in addition to apply: whether a log shows this effect, and where. Every one has it: a fit
    /// cannot determine the effects of a converter.
    std::optional<DetectedFault> (*detect)(const LoggedTorque& log) = nullptr;
};

/// All effects in the order of effects.def.
[[nodiscard]] std::span<const Effect* const> catalogue();

/// Throws UsageError with the nearest name.
[[nodiscard]] const Effect& find_effect(std::string_view name);

/// True when the effect's torque follows the angle of the motor, or is that of the gear ratio itself: it
/// means nothing in a model whose ratio is not known. A resonance acts on the torque as a whole as well.
[[nodiscard]] bool needs_gear_ratio(const Effect& effect);

/// Place of a parameter in effect.parameters; empty when the effect has none of that name.
[[nodiscard]] std::optional<std::size_t> find_parameter(const Effect& effect, std::string_view name);

// Detection of a converter effect in a log: whether it is present, and which samples it invalidates. No model
// of the joint is needed for that.

/// In units of the noise: finer steps of a log are dithered by the noise and bend nothing, so that a log of
/// four decimals has no fault.
inline constexpr double step_of_noise = 1.5;

/// A log as Effect::detect sees it. Spans have motion.size() entries.
struct LoggedTorque {
    const Motion& motion;  ///< as measured
    std::span<const double> torque_nm;
    std::span<const unsigned char> use;  ///< 0: does not count, be it for what an earlier detector found
    double moving_deg_s = 0.0;           ///< slower samples count as resting
    double step_nm = 0.0;   ///< distance of the values of a log that holds few; 0: as good as continuous
    double noise_nm = 0.0;  ///< rms, from second differences
};

struct DetectedFault {
    std::vector<double> values;  ///< values of the effect's parameters, in their order; bounds are ignored
    std::vector<std::size_t> spoiled;  ///< samples that do not hold the joint's torque, rising
    std::string words;                 ///< what was seen, for people
};

}  // namespace ripplenotch
