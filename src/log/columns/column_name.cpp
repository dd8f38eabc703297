// SPDX-License-Identifier: MIT
#include "log/columns/column_name.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>

#include "core/text/lower_case.hpp"
#include "log/columns/drive_objects.hpp"
#include "log/columns/units.hpp"
#include "ripplenotch/core/error.hpp"

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
    RoleWord{"torq", Role::torque, 0},
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
    RoleWord{"erpm", Role::velocity, 1},
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
    RoleWord{"asctime", Role::time, 1},
    RoleWord{"date", Role::time, 2},
};

constexpr std::array<std::string_view, 7> current_words = {"current", "currents", "iq",  "amps",
                                                           "strom",   "amperage", "curr"};
constexpr std::array<std::string_view, 22> reference_words = {
    "target",    "targets",  "ref",     "reference", "desired", "des",    "cmd",       "command",
    "commanded", "commands", "goal",    "setpoint",  "model",   "sim",    "simulated", "feedforward",
    "ff",        "soll",     "planned", "set",       "ctrl",    "control"};
// Quantities of something else: of the tool, of the mains, or derived from the one that is wanted.
// Of a linear axis; of an arm it is that of its tool.
constexpr RoleWord force_word{"force", Role::torque, 0};
constexpr std::array<std::string_view, 35> foreign_words = {
    "tcp",     "tool",      "pose",     "twist", "cartesian",   "wrench",        "force",
    "linear",  "scaling",   "fraction", "error", "err",         "ext",           "external",
    "hat",     "limit",     "limits",   "max",   "min",         "robot",         "main",
    "voltage", "execution", "cycle",    "delay", "temperature", "accelerations", "acceleration",
    "acc",     "ddq",       "ddot",     "qdd",   "override",    "deviation",     "derivative"};
// Parts of a torque, as models and simulators write them next to the whole.
constexpr std::array<std::string_view, 12> part_words = {
    "friction", "passive",  "gravity", "grav", "coriolis",   "centrifugal",
    "inertia",  "inertial", "damping", "bias", "constraint", "disturbance"};
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

// "j1_current_a": behind a current, a lower-case a is its unit.
void take_ampere(std::vector<Word>& words, std::string& unit) {
    if (!unit.empty() || words.size() < 2 || words.back().glued) return;
    const std::string& last = words.back().text;
    if ((last != "a" && last != "ma") || !std::any_of(words.begin(), words.end() - 1, [](const Word& word) {
            return contains(current_words, word.text);
        }))
        return;
    unit = last == "a" ? "A" : "mA";
    words.pop_back();
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

ColumnName read_column_name(std::string_view name, bool linear_axis) {
    ColumnName column;
    // The main program of a PLC; in lower case it is the mains.
    if (name.starts_with("MAIN.")) name.remove_prefix(std::string_view("MAIN.").size());
    // In an element of a list, "tau_nm[2]", the unit stands in front of the number.
    const std::size_t bracket = name.ends_with(']') ? name.rfind('[') : std::string_view::npos;
    const bool element =
        bracket != std::string_view::npos && is_digits(name.substr(bracket + 1, name.size() - bracket - 2));
    const NamedObject named = drive_object(element ? name.substr(0, bracket) : name);
    NameAndUnit parts = split_unit(named.name, linear_axis);
    if (element) parts.name += name.substr(bracket);
    column.unit = parts.unit;
    column.unit_is_sure = parts.bracketed;
    std::vector<Word> left;
    const RoleWord* found = nullptr;
    bool foreign = false, filtered = false, part = false;
    std::vector<Word> words = split_words(parts.name);
    std::string spoken;
    for (Word& word : words) {
        spoken += (spoken.empty() ? "" : " ") + word.text;
        if (const auto german = german_quantity(word.text)) {
            word.text = german->quantity;
            column.reference = column.reference || german->reference;
        }
    }
    take_ampere(words, column.unit);
    const bool of_current = std::any_of(words.begin(), words.end(),
                                        [](const Word& word) { return contains(current_words, word.text); });
    const DriveObject* const object = named.object != nullptr ? named.object : drive_object_named(spoken);
    for (std::size_t i = 0; i < words.size(); ++i) {
        const Word& word = words[i];
        // tau_J: the J is of the symbol; in tau_J1 it is of the joint.
        const bool numbered = i + 1 < words.size() && words[i + 1].glued;
        if (word.text == "j" && i > 0 && words[i - 1].text == "tau" && !numbered) continue;
        const auto role = std::find_if(role_words.begin(), role_words.end(),
                                       [&](const RoleWord& known) { return known.word == word.text; });
        const bool force = linear_axis && (word.text == "force" || word.text == "kraft");
        if (force) {
            found = &force_word;
            continue;
        }
        if (contains(foreign_words, word.text) || (word.text == "d" && of_current)) foreign = true;
        if (contains(part_words, word.text)) part = true;
        if (word.text == "motor" || word.text == "rotor") column.motor_side = true;
        if (word.text == "filtered" || word.text == "smoothed") filtered = true;
        if (contains(reference_words, word.text) || (word.text == "d" && found != nullptr)) {
            column.reference = true;
        } else if (contains(current_words, word.text)) {
            column.current = true;
        } else if (word.text == "q" && of_current) {
            continue;  // the axis of a motor's field, no coordinate
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
    if (object != nullptr) {
        if (found == nullptr && !column.current) {
            column.role = object->role;
            column.rank = object->current ? 1 : 0;
        }
        column.reference = column.reference || object->reference;
        column.current = column.current || object->current;
        if (column.unit.empty()) {
            column.unit = object->unit;
            column.unit_is_sure = false;
        }
    }
    const bool clock = column.role == Role::time;
    if (!clock) column.joint = joint_in_name(left);
    foreign = foreign || (part && column.role == Role::torque);
    if (foreign || (clock && !is_clock_name(left))) column.role = Role::other;
    if (column.motor_side && !column.current) column.rank += 2;
    if (filtered) column.rank += 4;
    // A torque in Nm comes before one in per cent, which is read only to be refused.
    if (parts.bracketed && column.role != Role::other && !usual_unit(parts.unit, column.role))
        column.rank += 8;
    return column;
}

namespace {

/// Letters that are a quantity where no other column is, and the names of other columns with which they may
/// be another one.
struct Symbol {
    std::string_view text;
    Role role;
    std::array<std::string_view, 4> rivals;
};
constexpr std::array symbols = {
    Symbol{"v", Role::velocity, {"i", "I", "u", "U"}},   // a voltage next to a current
    Symbol{"w", Role::velocity, {"x", "y", "z", "qx"}},  // of a quaternion
    Symbol{"\xcf\x89", Role::velocity, {}},
    Symbol{"T", Role::torque, {"i", "I", "iq", "current"}},  // a temperature next to a motor current
    Symbol{"M", Role::torque, {}},
    Symbol{"\xcf\x84", Role::torque, {}},
    Symbol{"th", Role::position, {}},
    Symbol{"phi", Role::position, {}},
    Symbol{"\xce\xb8", Role::position, {}},
    Symbol{"\xcf\x86", Role::position, {}},
};

/// "v" of "v", "v_3", "v3", "v[3]".
std::string_view without_number(std::string_view name) {
    if (name.ends_with(']')) name.remove_suffix(1);
    while (!name.empty() && is_digits(name.substr(name.size() - 1))) name.remove_suffix(1);
    while (!name.empty() && (name.back() == '_' || name.back() == '[' || name.back() == ' '))
        name.remove_suffix(1);
    return name;
}

}  // namespace

namespace {

// A speed in m/s, or a unit in brackets, is that of a linear axis; then so are "pos_m" and "force_N".
void read_linear_axis(const std::vector<std::string>& names, std::vector<ColumnName>& columns) {
    const bool linear = std::any_of(columns.begin(), columns.end(), [](const ColumnName& column) {
        const auto usual = usual_unit(column.unit, column.role);
        return column.role != Role::torque && usual && is_linear_unit(column.role, *usual);
    });
    if (!linear) return;
    for (std::size_t c = 0; c < names.size(); ++c) {
        ColumnName read = read_column_name(names[c], true);
        if (read.unit.empty())
            std::tie(read.unit, read.unit_is_sure) = std::tie(columns[c].unit, columns[c].unit_is_sure);
        columns[c] = std::move(read);
    }
}

}  // namespace

std::vector<ColumnName> read_column_names(const std::vector<std::string>& names,
                                          const std::vector<std::string>& units) {
    std::vector<ColumnName> columns;
    for (std::size_t c = 0; c < names.size(); ++c) {
        columns.push_back(read_column_name(names[c]));
        // What the file states comes before what a drive's profile says of all drives.
        const bool open =
            columns[c].unit.empty() || (is_device_unit(columns[c].unit) && !columns[c].unit_is_sure);
        if (!open || units.empty() || units[c].empty()) continue;
        columns[c].unit = units[c];
        columns[c].unit_is_sure = true;
    }
    read_linear_axis(names, columns);
    const auto has = [&columns](Role role, std::size_t but) {
        for (std::size_t c = 0; c < columns.size(); ++c)
            if (c != but && columns[c].role == role && columns[c].symbol == Role::other &&
                !columns[c].reference)
                return true;
        return false;
    };
    for (std::size_t c = 0; c < names.size(); ++c) {
        ColumnName& column = columns[c];
        const std::string bare = split_unit(names[c]).name;
        const auto symbol = std::find_if(symbols.begin(), symbols.end(), [&](const Symbol& known) {
            return known.text == without_number(bare);
        });
        if (symbol == symbols.end() || has(symbol->role, c)) continue;
        const bool by_unit = !column.unit.empty() && usual_unit(column.unit, symbol->role);
        if (!column.unit.empty() && !by_unit) continue;
        if (column.role == Role::time && !by_unit && !has(Role::time, c)) continue;
        const bool rivalled = std::any_of(names.begin(), names.end(), [&](const std::string& name) {
            return !name.empty() && contains(symbol->rivals, split_unit(name).name);
        });
        column.symbol = symbol->role;
        column.role = rivalled && !by_unit ? Role::other : symbol->role;
        column.joint = bare.substr(without_number(bare).size());
        std::erase_if(column.joint,
                      [](char sign) { return sign == '_' || sign == '[' || sign == ']' || sign == ' '; });
    }
    return columns;
}

std::string joint_key(std::string_view joint) {
    std::string key = lower_case(joint);
    for (const std::string_view prefix : {"joint_", "joint", "axis", "ax", "j", "a"}) {
        if (key.size() > prefix.size() && key.compare(0, prefix.size(), prefix) == 0 &&
            is_digits(std::string_view(key).substr(prefix.size()))) {
            return key.substr(prefix.size());
        }
    }
    return key;
}

namespace {

// Columns named one by one belong to a named joint only when their names agree on it.
std::string joint_of_forced(const KnownColumns& known) {
    const auto torque = known.forced.column_of(Role::torque);
    auto motion = known.forced.column_of(Role::velocity);
    if (!motion) motion = known.forced.column_of(Role::position);
    if (known.forced.by_place || !torque || !motion) return "";
    const std::string& joint = known.names[*torque].joint;
    return joint_key(joint) == joint_key(known.names[*motion].joint) ? joint : "";
}

// Torque and motion are named by --columns: the other columns of these roles tell nothing, nor do joints that
// have nothing else.
void drop_unasked(const KnownColumns& known, bool joint_asked, std::vector<JointGroup>& groups) {
    const auto& forced = known.forced;
    const auto torque = forced.column_of(Role::torque);
    const bool moves = forced.column_of(Role::velocity) || forced.column_of(Role::position);
    if (forced.by_place || !torque || !moves) return;
    const std::string of_torque = joint_key(known.names[*torque].joint);
    const auto is_unasked = [&](const JointGroup& group) {
        return group.key != of_torque &&
               std::all_of(motion_roles.begin(), motion_roles.end(),
                           [&](Role role) { return forced.column_of(role) || !group.has(role); });
    };
    if (joint_asked && std::all_of(groups.begin(), groups.end(), is_unasked) &&
        !joint_of_forced(known).empty())
        groups.clear();
    if (joint_asked) return;
    groups.erase(std::remove_if(groups.begin(), groups.end(), is_unasked), groups.end());
    const bool distinct = std::any_of(groups.begin(), groups.end(),
                                      [&](const JointGroup& group) { return group.key == of_torque; });
    if (groups.size() > 1 && !distinct) groups.clear();
}

std::vector<JointGroup> collect_groups(const KnownColumns& known, bool merge) {
    std::vector<JointGroup> groups;
    for (const bool reference : {false, true}) {
        for (std::size_t c = 0; c < known.facts.columns; ++c) {
            const ColumnName& name = known.names[c];
            if (known.forced.roles[c] || name.reference != reference) continue;
            if (name.role == Role::other || name.role == Role::time) continue;
            const std::string key = merge ? "" : joint_key(name.joint);
            auto group =
                std::find_if(groups.begin(), groups.end(), [&](const JointGroup& g) { return g.key == key; });
            if (group == groups.end()) {
                if (reference && !groups.empty()) continue;  // a wish alone does not make a joint
                groups.push_back({key, merge ? "" : name.joint, {}});
                group = groups.end() - 1;
            }
            group->candidates[name.role].push_back(c);
        }
    }
    return groups;
}

[[noreturn]] void refuse_tie(const KnownColumns& known, Role role, const std::vector<std::size_t>& best) {
    std::vector<std::string> labels, choices;
    for (const std::size_t c : best) {
        labels.push_back(column_label(known.facts.names, c));
        const bool repeated =
            std::count(known.facts.names.begin(), known.facts.names.end(), known.facts.names[c]) > 1;
        choices.push_back(fmt::format("--columns {}={}", role_name(role),
                                      repeated ? std::to_string(c + 1) : known.facts.names[c]));
    }
    raise<DataError>("{}: {} could each be the {}; use {}", known.source, fmt::join(labels, " and "),
                     role_name(role), fmt::join(choices, " or "));
}

}  // namespace

namespace {

/// The columns of one role whose joints are numbers.
struct Numbering {
    std::size_t lowest = 0, highest = 0, first_column = 0, columns = 0;
};

/// Number behind the letters of a joint's key, "left_3".
std::optional<std::size_t> number_of(std::string_view key) {
    const std::size_t letters = key.find_last_not_of("0123456789");
    key.remove_prefix(letters == std::string_view::npos ? 0 : letters + 1);
    constexpr std::size_t most_digits = 4;
    if (key.empty() || key.size() > most_digits) return std::nullopt;
    std::size_t number = 0;
    for (const char c : key) number = 10 * number + static_cast<std::size_t>(c - '0');
    return number;
}

// One of them has what the other has not, at both ends; of single columns, another number.
bool differ(const Numbering& a, const Numbering& b) {
    if (a.columns == 1 && b.columns == 1) return a.lowest != b.lowest;
    const auto shifted = [](const Numbering& from_0, const Numbering& from_1) {
        return from_0.lowest == 0 && from_1.lowest == 1 && from_1.highest > from_0.highest;
    };
    return shifted(a, b) || shifted(b, a);
}

}  // namespace

std::string mixed_numberings(const KnownColumns& known) {
    const auto& forced = known.forced;
    if (forced.column_of(Role::torque) &&
        (forced.column_of(Role::velocity) || forced.column_of(Role::position)))
        return "";
    std::map<std::string, std::map<Role, Numbering>> numberings;  // by the letters before the number
    for (std::size_t c = 0; c < known.facts.columns; ++c) {
        const ColumnName& name = known.names[c];
        if (name.reference || forced.roles[c] || name.role == Role::other || name.role == Role::time)
            continue;
        const std::string key = joint_key(name.joint);
        const auto number = number_of(key);
        if (!number) continue;
        const auto [found, first] =
            numberings[key.substr(0, key.find_last_not_of("0123456789") + 1)].try_emplace(
                name.role, Numbering{*number, *number, c, 0});
        Numbering& of_role = found->second;
        if (*number < of_role.lowest) of_role.lowest = *number, of_role.first_column = c;
        of_role.highest = std::max(of_role.highest, *number);
        ++of_role.columns;
    }
    for (const auto& [letters, roles] : numberings) {
        for (auto a = roles.begin(); a != roles.end(); ++a) {
            for (auto b = std::next(a); b != roles.end(); ++b) {
                if (!differ(a->second, b->second)) continue;
                const std::size_t first = a->second.first_column, second = b->second.first_column;
                const auto& names = known.facts.names;
                return fmt::format(
                    "{} is the first {} and {} the first {}: joints are numbered from {} and from {}; state "
                    "which columns are one joint's, with --columns {}={},{}={}",
                    column_label(names, first), role_name(a->first), column_label(names, second),
                    role_name(b->first), a->second.lowest, b->second.lowest, role_name(a->first),
                    names[first], role_name(b->first), names[second]);
            }
        }
    }
    return "";
}

std::vector<JointGroup> group_joints(const KnownColumns& known, bool joint_asked, bool needs_torque,
                                     std::vector<JointGroup>& incomplete) {
    std::vector<JointGroup> groups = collect_groups(known, false);
    drop_unasked(known, joint_asked, groups);
    const auto complete = [&](const JointGroup& group) {
        const auto has = [&](Role role) { return group.has(role) || known.forced.column_of(role); };
        return (has(Role::torque) || !needs_torque) && (has(Role::velocity) || has(Role::position));
    };
    if (groups.empty() && (known.forced.column_of(Role::torque) || known.forced.column_of(Role::velocity))) {
        const std::string joint = joint_of_forced(known);
        groups.push_back({joint_key(joint), joint, {}});
    }
    if (std::none_of(groups.begin(), groups.end(), complete) && groups.size() > 1 && !joint_asked) {
        // "motor_torque" and "link_velocity": one joint whose columns are named after different
        // things.
        std::array<std::size_t, 3> counts{};
        for (std::size_t r = 0; r < motion_roles.size(); ++r) {
            for (const JointGroup& group : groups) counts[r] += group.has(motion_roles[r]);
        }
        // "tau_motor_side" and "tau_sensor" with them: torques of the one joint that moves, to be chosen
        // from.
        const bool numbered = std::any_of(groups.begin(), groups.end(), [](const JointGroup& group) {
            return number_of(group.key).has_value();
        });
        if (counts[0] <= 1 && counts[2] <= 1 && (counts[1] <= 1 || !numbered))
            groups = collect_groups(known, true);
    }
    const bool any_complete = std::any_of(groups.begin(), groups.end(), complete);
    if (any_complete) {
        const auto rest = std::stable_partition(groups.begin(), groups.end(), complete);
        incomplete.assign(std::make_move_iterator(rest), std::make_move_iterator(groups.end()));
        groups.erase(rest, groups.end());
    }
    return groups;
}

std::optional<std::size_t> choose_column(const KnownColumns& known, const JointGroup& group, Role role,
                                         std::vector<LogWarning>& warnings) {
    if (const auto forced = known.forced.column_of(role)) return forced;
    const auto found = group.candidates.find(role);
    if (found == group.candidates.end()) return std::nullopt;
    const auto cost = [&known](std::size_t c) {
        return known.names[c].rank + (known.names[c].reference ? 100 : 0);
    };
    int lowest = 1000;
    for (const std::size_t c : found->second) lowest = std::min(lowest, cost(c));
    std::vector<std::size_t> best, still;
    for (const std::size_t c : found->second) {
        if (cost(c) != lowest) continue;
        const bool moves = known.facts.sample.empty() || varies(known.facts.sample[c]);
        (moves ? best : still).push_back(c);
    }
    if (best.empty()) best.swap(still);
    if (best.size() > 1) refuse_tie(known, role, best);
    if (!still.empty()) {
        warnings.push_back(
            {"standing column",
             fmt::format("{} does not change at the start of the log; the {} is taken from {}; --columns "
                         "{}=NAME decides otherwise",
                         column_label(known.facts.names, still.front()), role_name(role),
                         column_label(known.facts.names, best.front()), role_name(role)),
             true});
    }
    if (known.names[best.front()].reference) {
        warnings.push_back({"reference",
                            fmt::format("{} is a wish or a model, not a measurement, and the only {} here",
                                        column_label(known.facts.names, best.front()), role_name(role)),
                            true});
    }
    return best.front();
}

namespace {

constexpr std::array all_conventions = {
#define CONVENTION(family, beside, name, role, unit, side, source) \
    Convention{family, beside, name, Role::role, unit, Shaft::side, source},
#include "log/columns/conventions.def"
#undef CONVENTION
};

bool is_decimal_digit(char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; }

// ".joint.states.j1.velocity." of "/joint_states/j1/velocity"
std::string in_words(std::string_view name) {
    std::string words = ".";
    for (const char c : lower_case(name)) {
        if (std::isalnum(static_cast<unsigned char>(c)) != 0)
            words += c;
        else if (words.back() != '.')
            words += '.';
    }
    if (words.back() != '.') words += '.';
    return words;
}

// Whether `word` is the next one at `at`, perhaps with a number glued to it.
bool word_at(std::string_view words, std::size_t at, std::string_view word) {
    if (words.substr(at, word.size()) != word) return false;
    std::size_t end = at + word.size();
    while (end < words.size() && is_decimal_digit(words[end])) ++end;
    return end < words.size() && words[end] == '.';
}

// All words of the pattern, in this order, others between them allowed: a joint's name stands there.
bool follows(std::string_view words, std::string_view pattern) {
    if (!pattern.empty() && pattern.front() == '=')
        return words.substr(1, words.size() - 2) == pattern.substr(1);
    std::size_t at = 0;
    while (!pattern.empty()) {
        const std::string_view word = pattern.substr(0, pattern.find('.'));
        pattern.remove_prefix(std::min(pattern.size(), word.size() + 1));
        while (at != std::string_view::npos && !word_at(words, at + 1, word)) at = words.find('.', at + 1);
        if (at == std::string_view::npos) return false;
        at = words.find('.', at + 1);
    }
    return true;
}

bool stands_beside(std::string_view pattern, const std::vector<std::string>& names) {
    return std::any_of(names.begin(), names.end(),
                       [&](const std::string& name) { return follows(in_words(name), pattern); });
}

}  // namespace

std::span<const Convention> conventions() { return all_conventions; }

const Convention* convention_of(std::string_view name, Role role, const std::vector<std::string>& names) {
    const std::string words = in_words(name);
    for (const Convention& known : all_conventions) {
        if (role != Role::other && known.role != role) continue;
        if (follows(words, known.name) && (known.beside.empty() || stands_beside(known.beside, names)))
            return &known;
    }
    return nullptr;
}

}  // namespace ripplenotch
