// SPDX-License-Identifier: MIT
// The model of a joint for simulators and for Python.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <optional>
#include <string>

#include "export/text.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/visible_text.hpp"
#include "ripplenotch/export/joint_target.hpp"

namespace ripplenotch {

namespace {

constexpr Key joint_key{
    .name = "joint", .kind = KeyKind::text, .default_text = "joint", .help = "its name in the file"};

// What simulators leave to others; empty: that is for the target to say.
std::string others_part(const Effect& effect) {
    if (effect.side == Side::converter) return "it is a fault of the log";
    if (effect.side == Side::sensor || effect.name == "offset" || effect.name == "drift" ||
        effect.name == "tone")
        return "it is the torque sensor's, not the joint's";
    if (effect.side == Side::motion) return "it is an error of the log's motion";
    return "";
}

// MuJoCo.

constexpr std::array mjcf_keys = {joint_key};

WrittenJoint write_joint_mjcf(const Model& model, const Settings& settings,
                              std::span<const std::string> heading) {
    JointMjcf parts = joint_mjcf(model);
    std::string text = write_mjcf(parts, settings.text("joint"), heading);
    return {std::move(text), std::move(parts.holds), std::move(parts.not_held)};
}

const JointTarget mjcf_target{
    .name = "mjcf",
    .summary = "a body on one hinge, for MuJoCo",
    .source = "MuJoCo 3.14, XML reference",
    .endings = ".xml .mjcf",
    .keys = mjcf_keys,
    .write = write_joint_mjcf,
};

// Isaac Lab and mjlab: keyword arguments of their actuators.

constexpr std::array actuator_keys = {
    joint_key,
    Key{.name = "step",
        .dimension = Dimension::time,
        .default_text = "5ms",
        .above = 0.0,
        .help = "of the simulation, in which delays are counted"},
    Key{.name = "link-inertia",
        .at_least = 0.0,
        .help = "kgm2 of the link about the joint in the robot's description; the rest is armature"}};

struct Actuator {
    std::optional<double> armature, limit_nm;
    double sliding_nm = 0.0, stuck_nm = 0.0, viscous = 0.0;
    int delay_steps = 0;
};

// Where an actuator has the effect; empty: nowhere.
std::string place_in(Actuator& actuator, std::string_view name, const std::vector<double>& v,
                     const Settings& settings) {
    if (name == "coulomb-friction") {
        actuator.sliding_nm += v[0];
        return "friction, dynamic_friction; frictionloss";
    }
    if (name == "stribeck-friction") {
        actuator.stuck_nm += v[0];
        return "friction, of a joint that is held; it falls at once and not with the speed";
    }
    if (name == "viscous-friction") {
        actuator.viscous += v[0] * degrees_per_radian;
        return "viscous_friction";
    }
    if (name == "inertia" && settings.has("link-inertia")) {
        actuator.armature = to_digits(v[0] - settings.number("link-inertia"), 10);
        if (*actuator.armature < 0.0)
            raise<UsageError>("link-inertia={}: the joint has {} kgm2 in all",
                              shortest(settings.number("link-inertia")), shortest(v[0]));
        return "armature, less the link's";
    }
    if (name == "saturation") {
        actuator.limit_nm = v[0];
        return "effort_limit";
    }
    if (name == "delay") {
        actuator.delay_steps = static_cast<int>(std::lround(v[0] / settings.number("step")));
        return fmt::format("steps of the command: {}, for {} s", actuator.delay_steps, shortest(v[0]));
    }
    return "";
}

std::string why_not_in_actuator(const Effect& effect) {
    if (effect.name == "inertia") return "it is link and rotor in one; link-inertia= parts them";
    if (effect.name == "gravity") return "the robot's description has the masses";
    const std::string words = others_part(effect);
    return words.empty() ? "actuators have no place for it" : words;
}

// JSON of values that are JSON already.
std::string object(const Fields& fields, const std::string& indent) {
    const auto line = [&](const auto& field) {
        return fmt::format("{}  {}: {}", indent, in_quotes(field.first), field.second);
    };
    return fields.empty() ? "{}" : "{\n" + joined(fields, ",\n", line) + "\n" + indent + "}";
}

WrittenJoint write_actuator(const Model& model, const Settings& settings,
                            std::span<const std::string> heading) {
    WrittenJoint written;
    Actuator actuator;
    for (const Term& term : model.terms) {
        const std::string words = place_in(actuator, term.effect->name, values_of(term), settings);
        (words.empty() ? written.not_held : written.holds)
            .push_back(
                {std::string(term.effect->name), words.empty() ? why_not_in_actuator(*term.effect) : words});
    }
    const std::string joint = in_quotes(settings.text("joint")), delay = std::to_string(actuator.delay_steps);
    Fields isaac = {{"joint_names_expr", "[" + joint + "]"},
                    {"friction", shortest(actuator.sliding_nm + actuator.stuck_nm)},
                    {"dynamic_friction", shortest(actuator.sliding_nm)},
                    {"viscous_friction", shortest(actuator.viscous)},
                    {"min_delay", delay},
                    {"max_delay", delay}};
    Fields mjlab = {{"target_names_expr", "[" + joint + "]"},
                    {"frictionloss", shortest(actuator.sliding_nm)},
                    {"viscous_damping", shortest(actuator.viscous)},
                    {"delay_min_lag", delay},
                    {"delay_max_lag", delay}};
    for (Fields* one : {&isaac, &mjlab}) {
        if (actuator.armature) one->emplace_back("armature", shortest(*actuator.armature));
        if (actuator.limit_nm) one->emplace_back("effort_limit", shortest(*actuator.limit_nm));
    }
    std::vector<std::string> left;
    for (const MjcfPart& part : written.not_held)
        left.push_back(
            fmt::format("{{\"effect\": {}, \"reason\": {}}}", in_quotes(part.effect), in_quotes(part.words)));
    written.text = object({{"made", "[" + joined(heading, ", ", in_quotes) + "]"},
                           {"step_s", shortest(settings.number("step"))},
                           {"isaac_lab", object(isaac, "  ")},
                           {"mjlab", object(mjlab, "  ")},
                           {"not_held", fmt::format("[{}]", fmt::join(left, ",\n    "))}},
                          "") +
                   "\n";
    return written;
}

const JointTarget actuator_target{
    .name = "actuator",
    .summary = "friction, delay in steps and limits as arguments of actuators, for Isaac Lab and mjlab",
    .source = "Isaac Lab 2.3, DelayedPDActuatorCfg; mjlab 1.6, actuators",
    .endings = ".json",
    .keys = actuator_keys,
    .write = write_actuator,
};

// NumPy: the equations of the effects as Python; the report of the export prints the same text.

constexpr std::array numpy_keys = {
    Key{.name = "name", .kind = KeyKind::text, .default_text = "torque_nm", .help = "of the function"}};
constexpr std::array python_names = {"q",   "v",   "t",    "acceleration", "load", "gear_ratio",
                                     "cos", "sin", "tanh", "exp",          "pi"};

bool is_word(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; }

// A name, a number or a unit of an equation; empty for a name that is none of a motion.
std::optional<std::string> python_word(const Term& term, std::string_view word) {
    if (const auto place = find_parameter(*term.effect, word)) {
        const double value = values_of(term)[*place];
        return value < 0.0 ? fmt::format("({})", shortest(value)) : shortest(value);
    }
    if (word == "Nm" || word == "deg") return "";  // angles are in degrees throughout
    const bool is_number = std::isdigit(static_cast<unsigned char>(word.front())) != 0;
    if (is_number || std::ranges::find(python_names, word) != python_names.end()) return std::string(word);
    return std::nullopt;
}

// Empty: the torque is no function of the present motion.
std::string python_of(const Term& term) {
    constexpr std::string_view begins = "torque = ";
    std::string_view equation = term.effect->equation;
    if (term.effect->side != Side::joint || !equation.starts_with(begins)) return "";
    equation.remove_prefix(begins.size());
    equation = equation.substr(0, equation.find(", "));  // what its names mean follows
    std::string text;
    bool within = false;
    for (std::size_t i = 0; i < equation.size();) {
        if (is_word(equation[i])) {
            std::size_t end = i;
            while (end < equation.size() && is_word(equation[end])) ++end;
            const auto word = python_word(term, equation.substr(i, end - i));
            if (!word) return "";
            text += *word;
            i = end;
            continue;
        }
        if (equation[i] == '^')
            text += "**";
        else if (equation[i] == '|')
            text += (within = !within) ? "abs(" : ")";
        else
            text += equation[i];
        ++i;
    }
    return text;
}

std::string why_not_in_python(const Effect& effect) {
    if (effect.side == Side::joint) return "its torque is no function of the present motion of this joint";
    if (effect.side == Side::ripple) return "the ripple is written as it is without";
    return others_part(effect);
}

WrittenJoint write_numpy(const Model& model, const Settings& settings, std::span<const std::string> heading) {
    const std::string name = settings.text("name");
    check_identifier(name, "target numpy, name");
    WrittenJoint written;
    std::string load, rest;
    for (const Term& term : model.terms) {
        const Effect& effect = *term.effect;
        const bool ratio = effect.name == "gear-ratio";
        const std::string torque = python_of(term);
        if (torque.empty() && !ratio) {
            written.not_held.push_back({std::string(effect.name), why_not_in_python(effect)});
            continue;
        }
        written.holds.push_back({std::string(effect.name), ratio ? "gear_ratio" : torque});
        if (!ratio)
            (effect.bears_load ? load : rest) +=
                fmt::format("    {} = {} + {}  # {}\n", effect.bears_load ? "load" : "torque",
                            effect.bears_load ? "load" : "torque", torque, effect.name);
    }
    std::vector<std::string> lines(heading.begin(), heading.end());
    for (const MjcfPart& part : written.not_held)
        lines.push_back(fmt::format("not held: {}: {}", part.effect, part.words));
    written.text = comment_lines(lines, "# ") +
                   fmt::format(
                       "import numpy as np\n\n\n"
                       "def {}(position_deg, velocity_deg_s, acceleration_deg_s2, time_s=0.0):\n"
                       "    \"\"\"Torque of the joint in Nm, along a motion of the joint; time since the log "
                       "began.\"\"\"\n"
                       "    q, v, acceleration, t = (np.asarray(one, dtype=float) for one in\n"
                       "                             (position_deg, velocity_deg_s, acceleration_deg_s2, "
                       "time_s))\n"
                       "    cos, sin = (lambda angle: np.cos(np.radians(angle))), (lambda angle: "
                       "np.sin(np.radians(angle)))\n"
                       "    tanh, exp, pi, gear_ratio = np.tanh, np.exp, np.pi, {}\n"
                       "    load = 0 * q\n{}    torque = load\n{}    return torque\n",
                       name, shortest(ratio_of(model).value()), load, rest);
    return written;
}

const JointTarget numpy_target{
    .name = "numpy",
    .summary = "a function of motion, for Python with NumPy",
    .source = "NumPy 2",
    .endings = ".py",
    .keys = numpy_keys,
    .write = write_numpy,
};

constexpr const JointTarget* every_joint_target[] = {&mjcf_target, &actuator_target, &numpy_target};

}  // namespace

std::span<const JointTarget* const> joint_targets() { return every_joint_target; }

const JointTarget& find_joint_target(std::string_view name) {
    return find_entry(joint_targets(), "joint export target", "targets", name);
}

}  // namespace ripplenotch
