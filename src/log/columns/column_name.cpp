// SPDX-License-Identifier: MIT
#include "log/columns/column_name.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <span>
#include <vector>

#include "log/columns/unit_text.hpp"

namespace ripplenotch {
namespace {

struct RoleWord {
    std::string_view word;
    Role role;
    int rank;
};

constexpr std::array role_words = {
    RoleWord{"torque", Role::torque, 0},
    RoleWord{"torques", Role::torque, 0},
    RoleWord{"tau", Role::torque, 0},
    RoleWord{"effort", Role::torque, 0},
    RoleWord{"efforts", Role::torque, 0},
    RoleWord{"moment", Role::torque, 0},
    RoleWord{"moments", Role::torque, 0},
    RoleWord{"trq", Role::torque, 0},
    RoleWord{"drehmoment", Role::torque, 0},
    RoleWord{"velocity", Role::velocity, 0},
    RoleWord{"velocities", Role::velocity, 0},
    RoleWord{"vel", Role::velocity, 0},
    RoleWord{"velo", Role::velocity, 0},
    RoleWord{"speed", Role::velocity, 0},
    RoleWord{"dq", Role::velocity, 0},
    RoleWord{"qd", Role::velocity, 0},
    RoleWord{"qdot", Role::velocity, 0},
    RoleWord{"qvel", Role::velocity, 0},
    RoleWord{"omega", Role::velocity, 0},
    RoleWord{"drehzahl", Role::velocity, 0},
    RoleWord{"geschwindigkeit", Role::velocity, 0},
    RoleWord{"dtheta", Role::velocity, 1},
    RoleWord{"position", Role::position, 0},
    RoleWord{"positions", Role::position, 0},
    RoleWord{"pos", Role::position, 0},
    RoleWord{"q", Role::position, 0},
    RoleWord{"angle", Role::position, 0},
    RoleWord{"angles", Role::position, 0},
    RoleWord{"qpos", Role::position, 0},
    RoleWord{"winkel", Role::position, 0},
    RoleWord{"theta", Role::position, 1},
    RoleWord{"time", Role::time, 0},
    RoleWord{"t", Role::time, 0},
    RoleWord{"timestamp", Role::time, 0},
    RoleWord{"stamp", Role::time, 0},
    RoleWord{"timestamps", Role::time, 0},
    RoleWord{"zeit", Role::time, 0},
    RoleWord{"elapsed", Role::time, 0},
    RoleWord{"duration", Role::time, 1},
    RoleWord{"datetime", Role::time, 1},
    RoleWord{"date", Role::time, 2},
};

constexpr std::array<std::string_view, 7> current_words = {"current", "currents", "iq",  "amps",
                                                           "strom",   "amperage", "curr"};
constexpr std::array<std::string_view, 20> reference_words = {
    "target",    "targets",     "ref",      "reference", "desired",  "des",   "cmd",
    "command",   "commanded",   "commands", "goal",      "setpoint", "model", "sim",
    "simulated", "feedforward", "ff",       "soll",      "planned",  "set"};
// Quantities of something else: of the tool, of the mains, or derived from the one that is wanted.
constexpr std::array<std::string_view, 35> foreign_words = {
    "tcp",     "tool",      "pose",     "twist", "cartesian",   "wrench",        "force",
    "linear",  "scaling",   "fraction", "error", "err",         "ext",           "external",
    "hat",     "limit",     "limits",   "max",   "min",         "robot",         "main",
    "voltage", "execution", "cycle",    "delay", "temperature", "accelerations", "acceleration",
    "acc",     "ddq",       "ddot",     "qdd",   "override",    "deviation",     "derivative"};
// Words that say how or where, not which joint.
constexpr std::array<std::string_view, 25> general_words = {
    "state",  "states", "actual",   "act",   "measured", "meas", "msr",    "measurement", "value",
    "values", "raw",    "joints",   "motor", "rotor",    "load", "link",   "output",      "shaft",
    "sensor", "signal", "filtered", "log",   "data",     "ist",  "encoder"};

bool contains(std::span<const std::string_view> words, std::string_view word) {
    return std::find(words.begin(), words.end(), word) != words.end();
}

struct Word {
    std::string text;    // lower case
    bool glued = false;  // follows the word before without anything between: "j" "4" of "j4"
};

bool is_digits(std::string_view text) {
    return !text.empty() &&
           std::all_of(text.begin(), text.end(), [](unsigned char c) { return std::isdigit(c) != 0; });
}

// q_dot and theta_dot are one symbol each.
void join_dots(std::vector<Word>& words) {
    for (std::size_t i = 0; i + 1 < words.size(); ++i) {
        const bool angle = words[i].text == "q" || words[i].text == "theta";
        if (!angle || words[i + 1].text != "dot") continue;
        words[i].text = words[i].text == "q" ? "qdot" : "dtheta";
        words.erase(words.begin() + static_cast<std::ptrdiff_t>(i) + 1);
    }
}

// "actualVelocity_3" -> actual, Velocity (glued), 3
std::vector<Word> split_words(std::string_view name) {
    std::vector<Word> words;
    const auto kind = [](unsigned char c) {
        return std::isdigit(c) != 0 ? 'd' : std::isupper(c) != 0 ? 'U' : 'l';
    };
    char before = 0;
    for (const char c : name) {
        const auto byte = static_cast<unsigned char>(c);
        if (std::isalnum(byte) == 0 && byte < 0x80) {
            before = 0;
            continue;
        }
        const char now = kind(byte);
        const bool digit_edge = before != 0 && (now == 'd') != (before == 'd');
        if (before == 0 || digit_edge || (before == 'l' && now == 'U')) words.push_back({"", before != 0});
        words.back().text += static_cast<char>(std::tolower(byte));
        before = now;
    }
    join_dots(words);
    return words;
}

// What is left of a name once quantity and unit are gone: "j4", "3", "wrist_1_joint", or nothing.
std::string joint_in_name(const std::vector<Word>& left) {
    std::vector<Word> words;
    for (const Word& word : left) {
        if (!contains(general_words, word.text)) words.push_back(word);
    }
    const auto prefix = [](std::string_view text) {
        return text == "j" || text == "joint" || text == "axis" || text == "a" || text == "ax";
    };
    if (words.size() == 1 && prefix(words[0].text)) return "";
    if (words.size() == 2 && prefix(words[0].text) && is_digits(words[1].text)) {
        return words[1].glued ? words[0].text + words[1].text : words[1].text;
    }
    std::string joint;
    for (const Word& word : words) {
        if (!joint.empty() && !word.glued) joint += '_';
        joint += word.text;
    }
    return joint;
}

// A time column is called so and little else: "actual_execution_time" is not the clock of the log.
bool is_clock_name(const std::vector<Word>& left) {
    return std::all_of(left.begin(), left.end(), [](const Word& word) {
        return contains(general_words, word.text) || word.text == "stamp" || word.text == "time" ||
               word.text == "elapsed" || word.text == "ros" || word.text == "header" ||
               word.text == "sample" || word.text == "since" || word.text == "start" || word.text == "unix" ||
               word.text == "epoch" || word.text == "boot" || word.text == "log" || word.text == "system";
    });
}

}  // namespace

ColumnName read_column_name(std::string_view name) {
    ColumnName column;
    // Of an element of a list, "tau_nm[2]", the unit stands in front of the number.
    const std::size_t bracket = name.ends_with(']') ? name.rfind('[') : std::string_view::npos;
    const bool element =
        bracket != std::string_view::npos && is_digits(name.substr(bracket + 1, name.size() - bracket - 2));
    NameAndUnit parts = split_unit(element ? name.substr(0, bracket) : name);
    if (element) parts.name += name.substr(bracket);
    column.unit = parts.unit;
    column.unit_is_sure = parts.bracketed;

    std::vector<Word> left;
    const RoleWord* found = nullptr;
    bool foreign = false, filtered = false;
    const std::vector<Word> words = split_words(parts.name);
    for (std::size_t i = 0; i < words.size(); ++i) {
        const Word& word = words[i];
        // tau_J: the J is of the symbol; in tau_J1 it is of the joint.
        const bool numbered = i + 1 < words.size() && words[i + 1].glued;
        if (word.text == "j" && i > 0 && words[i - 1].text == "tau" && !numbered) continue;
        const auto role = std::find_if(role_words.begin(), role_words.end(),
                                       [&](const RoleWord& known) { return known.word == word.text; });
        if (contains(foreign_words, word.text)) foreign = true;
        if (word.text == "motor" || word.text == "rotor") column.motor_side = true;
        if (word.text == "filtered" || word.text == "smoothed") filtered = true;
        if (contains(reference_words, word.text) || (word.text == "d" && found != nullptr)) {
            column.reference = true;
        } else if (contains(current_words, word.text)) {
            column.current = true;
        } else if (role != role_words.end() && (found == nullptr || found->role == Role::time)) {
            found = role;
        } else {
            left.push_back(word);
        }
    }
    if (found == nullptr && column.current) {
        column.role = Role::torque;
        column.rank = 1;
    } else if (found != nullptr) {
        column.role = found->role;
        column.rank = found->rank;
        column.current = false;
    }
    const bool clock = column.role == Role::time;
    if (!clock) column.joint = joint_in_name(left);
    if (foreign || (clock && !is_clock_name(left))) column.role = Role::other;
    if (column.motor_side && !column.current) column.rank += 2;
    if (filtered) column.rank += 4;
    // A torque in Nm comes before one in per cent, which is read only to be refused.
    if (parts.bracketed && column.role != Role::other && !usual_unit(parts.unit, column.role))
        column.rank += 8;
    return column;
}

std::string joint_key(std::string_view joint) {
    std::string key;
    for (const char c : joint) key += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    for (const std::string_view prefix : {"joint_", "joint", "axis", "ax", "j", "a"}) {
        if (key.size() > prefix.size() && key.compare(0, prefix.size(), prefix) == 0 &&
            is_digits(std::string_view(key).substr(prefix.size()))) {
            return key.substr(prefix.size());
        }
    }
    return key;
}

}  // namespace ripplenotch
