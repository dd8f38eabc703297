// SPDX-License-Identifier: MIT
#pragma once
// The model of a joint as MuJoCo's own description has it, as far as it has a place for it.

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "ripplenotch/model/model.hpp"

namespace ripplenotch {

/// An effect of a model, and where MuJoCo holds it or why it does not.
struct MjcfPart {
    std::string effect;
    std::string words;  ///< "frictionloss", or a reason
    bool operator==(const MjcfPart&) const = default;
};

/// A dcmotor whose cogging is amplitude_nm * sin(poles * q + phase_rad), q the joint's angle in rad.
struct MjcfWave {
    std::string name;  ///< "ripple_1": of order 1
    double amplitude_nm = 0.0, poles = 0.0, phase_rad = 0.0;
};

/// A dcmotor whose lugre is a bristle that slips at `friction_nm`.
struct MjcfBristle {
    std::string name;  ///< "friction_1"
    double stiffness_nm_rad = 0.0, friction_nm = 0.0;
};

/// The parts that were written, and the accuracy of the result.
struct MjcfAccount {
    std::string file;
    std::vector<MjcfPart> holds, not_held;
    /// rms of measured less predicted torque with the terms that are held alone: of the model as given and of
    /// the improved one. MuJoCo along the same motion gives the same.
    double before_nm = 0.0, after_nm = 0.0;
};

/// The parts of a model that a joint of MuJoCo 3.14 holds, in its units: newton-metres, radians, seconds.
struct JointMjcf {
    Model held;  ///< the terms that it holds, as it holds them, for their torque by predict_nm
    std::vector<MjcfPart> holds, not_held;
    double inertia_kgm2 = 0.0;
    double damping = 0.0;            ///< Nm per rad/s
    double quadratic_damping = 0.0;  ///< Nm per (rad/s)^2, times v |v|
    double frictionloss_nm = 0.0;
    double friction_width_rad_s = 0.0;  ///< width of the tanh that replaces the step in the model
    double weight_nm = 0.0, weight_rad = 0.0;
    std::vector<MjcfWave> waves;
    std::vector<MjcfBristle> bristles;
};

/// Of the model, with its effect gear-ratio.
[[nodiscard]] GearRatio ratio_of(const Model& model);

/// Decomposes the model. Every value has to be stated. Armature, damping, frictionloss, cogging and the
/// weight of a link are as defined in docs/effects; hysteresis is a LuGre bristle without damping whose
/// friction is the same at every speed (Dahl's model). Throws std::bad_optional_access where values are left
/// out.
[[nodiscard]] JointMjcf joint_mjcf(const Model& model);

/// A file of its own: one body on one hinge of the name `joint`. Friction is made soft so that MuJoCo's rises
/// where the model's does: tanh(v / width) in two straight steps, frictionloss of the joint and of a tendon
/// round it, whose sum is the friction.
/// The reading of a torque sensor is qfrc_inverse, plus the force of the actuators ripple_*, less that of
/// friction_*. `heading` becomes a comment.
[[nodiscard]] std::string write_mjcf(const JointMjcf& mjcf, std::string_view joint,
                                     std::span<const std::string> heading);

/// The user's own file with the joint's damping, frictionloss and motors in it; all else stays as it is,
/// masses too. Throws UsageError: `source` has no hinge of this name in its worldbody.
[[nodiscard]] std::string write_into_mjcf(const JointMjcf& mjcf, std::string_view text,
                                          const std::string& source, std::string_view joint,
                                          std::span<const std::string> heading);

}  // namespace ripplenotch
