// SPDX-License-Identifier: MIT
#include "log/columns/column_name.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <map>
#include <set>
#include <tuple>

#include "core/text/lower_case.hpp"
#include "log/columns/units.hpp"
#include "ripplenotch/core/error.hpp"

namespace ripplenotch {

namespace {

// The table of names, by word.

enum class Meaning : unsigned {
    time,
    velocity,
    torque,
    position,
    current,
    reference,
    foreign,
    force,
    part,
    general,
    motor,
    filtered,
    sensor,
    joint,
    clock,
};

struct WordLine {
    std::string_view words;
    Meaning meaning;
    int rank;
};
struct Symbol {
    std::string_view text;
    Role role;
    std::string_view rivals;
};
struct DriveObject {
    unsigned index = 0;  ///< of the first axis
    Role role = Role::other;
    Meaning meaning;
    std::string_view unit, words;
};

#define WORDS(language, meaning, rank, words) WordLine{words, Meaning::meaning, rank},
constexpr std::array word_lines = {
#include "log/columns/names.def"
};
#define NAME(family, beside, names, role, unit, side, source) \
    Convention{family, beside, names, Role::role, unit, Shaft::side, source},
constexpr std::array all_conventions = {
#include "log/columns/names.def"
};
#define SYMBOL(text, role, rivals) Symbol{text, Role::role, rivals},
constexpr std::array symbols = {
#include "log/columns/names.def"
};
#define OBJECT(index, role, meaning, unit, words) \
    DriveObject{index, Role::role, Meaning::meaning, unit, words},
constexpr std::array drive_objects = {
#include "log/columns/names.def"
};

/// What a word may mean.
struct Sense {
    unsigned meanings = 0;
    int rank = 0;
    [[nodiscard]] bool is(Meaning meaning) const {
        return (meanings >> static_cast<unsigned>(meaning) & 1U) != 0;
    }
    [[nodiscard]] Role role() const {
        // The roles, in this order, are the first of the meanings.
        for (unsigned role = 0; role < static_cast<unsigned>(Role::other); ++role)
            if (is(Meaning{role})) return Role{static_cast<int>(role)};
        return Role::other;
    }
};

Sense sense_of(std::string_view word) {
    static const auto table = [] {
        std::map<std::string_view, Sense> senses;
        for (const WordLine& line : word_lines) {
            for_each_word(line.words, [&](std::string_view one) {
                Sense& sense = senses[one];
                sense.meanings |= 1U << static_cast<unsigned>(line.meaning);
                sense.rank = std::max(sense.rank, line.rank);
            });
        }
        return senses;
    }();
    const auto found = table.find(word);
    return found == table.end() ? Sense{} : found->second;
}

struct Word {
    std::string text;    // lower case
    bool glued = false;  // follows the word before without anything between: "j" "4" of "j4"
    Sense sense = {};
};

// q_dot and theta_dot are one symbol each.
void join_dots(std::vector<Word>& words) {
    for (std::size_t i = 0; i + 1 < words.size(); ++i) {
        const bool angle = words[i].text == "q" || words[i].text == "theta";
        if (!angle || words[i + 1].text != "dot") continue;
        words[i].text = words[i].text == "q" ? "qdot" : "dtheta";
        words.erase(words.begin() + static_cast<std::ptrdiff_t>(i) + 1);
    }
}

// "abtriebsdrehzahl" is abtrieb and drehzahl, "motorspeed" motor and speed: words of the table, the longest
// first, which German joins by s, n or en. Short ones are in words by chance.
bool cut_compound(std::string_view text, std::vector<std::string_view>& parts) {
    constexpr std::size_t shortest = 3;
    for (std::size_t size = text.size(); size >= shortest; --size) {
        const std::string_view part = text.substr(0, size);
        if (sense_of(part).meanings == 0) continue;
        parts.push_back(part);
        if (size == text.size()) return true;
        for (const std::string_view link : {"", "s", "n", "en"}) {
            if (text.substr(size).starts_with(link) && cut_compound(text.substr(size + link.size()), parts))
                return true;
        }
        parts.pop_back();
    }
    return false;
}

void push_word(std::vector<Word>& words, const Word& word) {
    std::vector<std::string_view> parts;
    const bool known = sense_of(word.text).meanings != 0;
    if (known || !cut_compound(word.text, parts) || std::ranges::none_of(parts, [](std::string_view part) {
            return sense_of(part).role() != Role::other || sense_of(part).is(Meaning::current);
        }))
        parts = {word.text};
    for (const std::string_view part : parts)
        words.push_back({std::string(part), word.glued || part.data() != parts.front().data()});
}

// "actualVelocity_3" -> actual, Velocity (glued), 3
std::vector<Word> split_words(std::string_view name) {
    std::vector<Word> pieces;
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
        if (before == 0 || digit_edge || (before == 'l' && now == 'U')) pieces.push_back({"", before != 0});
        pieces.back().text += static_cast<char>(std::tolower(byte));
        before = now;
    }
    std::vector<Word> words;
    for (const Word& piece : pieces) push_word(words, piece);
    join_dots(words);
    for (Word& word : words) word.sense = sense_of(word.text);
    return words;
}

// "j1_current_a": behind a current, a lower-case a is its unit.
void take_ampere(std::vector<Word>& words, std::string& unit) {
    if (!unit.empty() || words.size() < 2 || words.back().glued) return;
    const std::string& last = words.back().text;
    if ((last != "a" && last != "ma") || !std::any_of(words.begin(), words.end() - 1, [](const Word& word) {
            return word.sense.is(Meaning::current);
        }))
        return;
    unit = last == "a" ? "A" : "mA";
    words.pop_back();
}

// What is left of a name once quantity and unit are gone: "j4", "3", "wrist_1_joint", or nothing.
std::string joint_in_name(const std::vector<Word>& words) {
    const auto prefix = [](const Word& word) { return word.sense.is(Meaning::joint); };
    if (words.size() == 1 && prefix(words[0])) return "";
    if (words.size() == 2 && prefix(words[0]) && is_digits(words[1].text)) {
        return words[1].glued ? words[0].text + words[1].text : words[1].text;
    }
    std::string joint;
    for (const Word& word : words) {
        if (!joint.empty() && !word.glued) joint += '_';
        joint += word.text;
    }
    return joint;
}

/// The object whose index a name holds ("velocity_actual_value_0x606C", "6064h", "16#6077:00"), and the name
/// without it, with "axis2" for a drive's second axis, whose objects stand 0x800 further, and so on.
struct NamedObject {
    const DriveObject* object = nullptr;
    std::string name;
};

NamedObject drive_object(std::string_view name) {
    constexpr unsigned first_index = 0x6000, next_axis = 0x800, last_index = 0x9FFF;
    const auto is_hex = [](char c) { return std::isxdigit(static_cast<unsigned char>(c)) != 0; };
    const auto is_alnum = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0; };
    for (std::size_t at = 0; at + 4 <= name.size(); ++at) {
        if (!std::all_of(name.begin() + static_cast<std::ptrdiff_t>(at),
                         name.begin() + static_cast<std::ptrdiff_t>(at) + 4, is_hex))
            continue;
        std::size_t begin = at, end = at + 4;
        const std::string_view before = name.substr(0, at);
        if (before.ends_with("0x") || before.ends_with("0X"))
            begin -= 2;
        else if (before.ends_with("16#"))
            begin -= 3;
        const bool marked = begin < at || (end < name.size() && (name[end] == 'h' || name[end] == 'H'));
        if (begin == at && marked) ++end;
        // A number of four digits that nothing marks is an index only where it is a word of its own.
        if ((begin > 0 && is_alnum(name[begin - 1])) || (end < name.size() && is_alnum(name[end]))) continue;
        unsigned index = 0;
        std::from_chars(name.data() + at, name.data() + at + 4, index, 16);
        if (index < first_index || index > last_index) continue;
        const auto* const object = std::ranges::find_if(drive_objects, [index](const DriveObject& known) {
            return known.index == first_index + (index - first_index) % next_axis;
        });
        if (object == drive_objects.end()) continue;
        // The sub-index: ":00", "_00", ".0".
        if (end < name.size() && std::string_view(":_.").find(name[end]) != std::string_view::npos) {
            const std::size_t zeros = name.find_first_not_of('0', end + 1);
            const std::size_t after = zeros == std::string_view::npos ? name.size() : zeros;
            if (after > end + 1 && (after == name.size() || !is_alnum(name[after]))) end = after;
        }
        const unsigned axis = (index - first_index) / next_axis;
        std::string rest(name.substr(0, begin));
        rest += axis > 0 ? fmt::format("_axis{}_", axis + 1) : "_";
        rest += name.substr(end);
        while (rest.ends_with('_')) rest.pop_back();
        return {object, rest};
    }
    return {nullptr, std::string(name)};
}

const DriveObject* drive_object_named(const std::vector<Word>& words) {
    std::string spoken;
    for (const Word& word : words) spoken += (spoken.empty() ? "" : " ") + word.text;
    for (const DriveObject& known : drive_objects)
        if (!known.words.empty() && spoken.find(known.words) != std::string::npos) return &known;
    return nullptr;
}

/// The quantity that a name's words name, and which word does. A force is one of a linear axis only.
struct Named {
    Role role = Role::other;
    bool current = false;  ///< a motor current in place of a torque
    std::size_t word = 0;
    int rank = 0;
};
Named quantity_of(const std::vector<Word>& words, bool linear_axis) {
    Named found;
    bool current = false;
    const bool of_current =
        std::ranges::any_of(words, [](const Word& word) { return word.sense.is(Meaning::current); });
    for (std::size_t i = 0; i < words.size(); ++i) {
        const Sense& sense = words[i].sense;
        if (linear_axis && sense.is(Meaning::force)) return {Role::torque, false, i, 0};
        if (sense.is(Meaning::reference)) continue;
        current = current || sense.is(Meaning::current);
        if (words[i].text == "q" && of_current) continue;  // the axis of a motor's field, no coordinate
        if (sense.role() != Role::other && (found.role == Role::other || found.role == Role::time))
            found = {sense.role(), false, i, sense.rank};
    }
    return found.role == Role::other && current ? Named{Role::torque, true, words.size(), 1} : found;
}

// A time column is called so and little else: "actual_execution_time" is not the clock of the log.
bool is_clock_name(const std::vector<Word>& left) {
    return std::ranges::all_of(left, [](const Word& word) {
        return word.sense.is(Meaning::general) || word.sense.is(Meaning::clock);
    });
}

/// "v" of "v", "v_3", "v3", "v[3]".
std::string_view without_number(std::string_view name) {
    if (name.ends_with(']')) name.remove_suffix(1);
    while (!name.empty() && is_digit(name.back())) name.remove_suffix(1);
    while (!name.empty() && (name.back() == '_' || name.back() == '[' || name.back() == ' '))
        name.remove_suffix(1);
    return name;
}

// A speed in m/s, or a unit in brackets, is that of a linear axis; then so are "pos_m" and "force_N".
void read_linear_axis(const std::vector<std::string>& names, std::vector<ColumnName>& columns) {
    const bool linear = std::ranges::any_of(columns, [](const ColumnName& column) {
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
    const std::size_t end = words.find_first_not_of("0123456789", at + word.size());
    return end != std::string_view::npos && words[end] == '.';
}

// All words of the pattern, in this order, others between them allowed: a joint's name stands there.
bool follows(std::string_view words, std::string_view pattern) {
    if (pattern.starts_with('=')) return words.substr(1, words.size() - 2) == pattern.substr(1);
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

void follow_conventions(const std::vector<std::string>& names, std::vector<ColumnName>& columns) {
    std::vector<std::string> words;
    for (const std::string& name : names) words.push_back(in_words(name));
    for (const Convention& known : conventions()) {
        const auto fits = [&](const std::string& of_column) {
            bool any = false;
            for_each_word(known.names,
                          [&](std::string_view pattern) { any = any || follows(of_column, pattern); });
            return any;
        };
        if (!known.beside.empty() && std::ranges::none_of(words, [&](const std::string& other) {
                return follows(other, known.beside);
            }))
            continue;
        for (std::size_t c = 0; c < columns.size(); ++c)
            if (fits(words[c])) columns[c].conventions.push_back(&known);
    }
}

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
        return group.key != of_torque && std::ranges::all_of(motion_roles, [&](Role role) {
                   return forced.column_of(role) || !group.has(role);
               });
    };
    if (joint_asked && std::ranges::all_of(groups, is_unasked) && !joint_of_forced(known).empty())
        groups.clear();
    if (joint_asked) return;
    groups.erase(std::remove_if(groups.begin(), groups.end(), is_unasked), groups.end());
    const bool distinct =
        std::ranges::any_of(groups, [&](const JointGroup& group) { return group.key == of_torque; });
    if (groups.size() > 1 && !distinct) groups.clear();
}

std::vector<JointGroup> collect_groups(const KnownColumns& known, bool merge) {
    std::vector<JointGroup> groups;
    std::map<std::string, std::size_t> places;
    for (const bool reference : {false, true}) {
        for (std::size_t c = 0; c < known.facts.columns; ++c) {
            const ColumnName& name = known.names[c];
            if (known.forced.roles[c] || name.reference != reference) continue;
            if (name.role == Role::other || name.role == Role::time) continue;
            const std::string key = merge ? "" : joint_key(name.joint);
            if (places.count(key) == 0) {
                if (reference && !groups.empty()) continue;  // a wish alone does not make a joint
                places[key] = groups.size();
                groups.push_back({key, merge ? "" : name.joint, {}});
            }
            groups[places[key]].of(name.role).push_back(c);
        }
    }
    return groups;
}

[[noreturn]] void refuse_tie(const KnownColumns& known, Role role, const std::vector<std::size_t>& best) {
    std::vector<std::string> labels, choices;
    for (const std::size_t c : best) {
        labels.push_back(column_label(known.facts.names, c));
        const std::string& name = known.facts.names[c];
        const bool plain = name.find_first_of(" ,=()[]'\"&;") == std::string::npos &&
                           std::ranges::count(known.facts.names, name) == 1;
        choices.push_back(
            fmt::format("--columns {}={}", role_name(role), plain ? name : std::to_string(c + 1)));
    }
    raise<DataError>("{}: {} could each be the {}; use {}", known.source, fmt::join(labels, " and "),
                     role_name(role), fmt::join(choices, " or "));
}

/// The columns of one role, by the number of their joint.
using Numbering = std::multimap<std::size_t, std::size_t>;

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
    if (a.size() == 1 && b.size() == 1) return a.begin()->first != b.begin()->first;
    const auto shifted = [](const Numbering& from_0, const Numbering& from_1) {
        return from_0.begin()->first == 0 && from_1.begin()->first == 1 &&
               from_1.rbegin()->first > from_0.rbegin()->first;
    };
    return shifted(a, b) || shifted(b, a);
}

/// "sm_2", of which there is a torque alone, is another torque of joint 2; "sensor" of the one joint that has
/// no name.
void share_torques(std::vector<JointGroup>& groups) {
    const auto moves = [](const JointGroup& group) {
        return group.has(Role::velocity) || group.has(Role::position);
    };
    const auto still = std::stable_partition(groups.begin(), groups.end(), moves);
    std::map<std::string, JointGroup*> moving;
    for (auto group = groups.begin(); group != still; ++group) moving[group->key] = &*group;
    const auto shared = [&](const JointGroup& group) {
        auto owner = moving.size() == 1 ? moving.find("") : moving.end();
        for (std::size_t cut = group.key.find('_'); cut != std::string::npos;
             cut = group.key.find('_', cut + 1))
            if (const auto named = moving.find(joint_key(group.key.substr(cut + 1))); named != moving.end())
                owner = named;
        if (owner == moving.end()) return false;
        std::vector<std::size_t>& torques = owner->second->of(Role::torque);
        const std::vector<std::size_t>& more = group.of(Role::torque);
        torques.insert(torques.end(), more.begin(), more.end());
        return true;
    };
    groups.erase(std::remove_if(still, groups.end(), shared), groups.end());
}

}  // namespace

bool is_known_word(std::string_view text) {
    const std::vector<Word> words = split_words(text);
    return !words.empty() &&
           std::ranges::all_of(words, [](const Word& word) { return word.sense.meanings != 0; });
}

const Convention* ColumnName::convention(Role as) const {
    const auto found = std::ranges::find_if(
        conventions, [as](const Convention* known) { return as == Role::other || known->role == as; });
    return found == conventions.end() ? nullptr : *found;
}

ColumnName read_column_name(std::string_view name, bool linear_axis) {
    ColumnName column;
    // The main program of a PLC; in lower case it is the mains.
    if (name.starts_with("MAIN.")) name.remove_prefix(std::string_view("MAIN.").size());
    // In an element of a list, "tau_nm[2]", the unit stands in front of the number.
    const std::size_t bracket = name.ends_with(']') ? name.rfind('[') : std::string_view::npos;
    const bool element =
        bracket != std::string_view::npos && is_digits(name.substr(bracket + 1, name.size() - bracket - 2));
    const NamedObject named = drive_object(element ? name.substr(0, bracket) : name);
    std::vector<Word> words = split_words(named.name);
    const DriveObject* const object = named.object != nullptr ? named.object : drive_object_named(words);
    // What is measured decides which last words are a unit: "velocity_min" is no time.
    Named quantity = quantity_of(words, linear_axis);
    if (quantity.role == Role::other && object != nullptr)
        quantity = {object->role, object->meaning == Meaning::current, words.size(),
                    object->meaning == Meaning::current ? 1 : 0};
    NameAndUnit parts = split_unit(named.name, quantity.role, linear_axis);
    if (element) parts.name += name.substr(bracket);
    column.unit = parts.unit;
    column.bare = parts.name;
    column.unit_is_sure = parts.bracketed;
    words = split_words(parts.name);
    take_ampere(words, column.unit);
    // "motor_rpm" is a velocity by its unit alone.
    if (const Named rest = quantity_of(words, linear_axis); rest.role != Role::other)
        quantity = rest;
    else
        quantity.word = words.size();
    column.role = quantity.role;
    column.rank = quantity.rank;
    column.current = quantity.current || (object != nullptr && object->meaning == Meaning::current);
    column.reference = object != nullptr && object->meaning == Meaning::reference;
    const bool of_current =
        std::ranges::any_of(words, [](const Word& word) { return word.sense.is(Meaning::current); });
    bool foreign = false, filtered = false;
    std::vector<Word> left;
    for (std::size_t i = 0; i < words.size(); ++i) {
        const Word& word = words[i];
        const Sense& sense = word.sense;
        // tau_J, the sensor's: the J is of the symbol; in tau_J1 it is of the joint.
        const bool numbered = i + 1 < words.size() && words[i + 1].glued;
        if (word.text == "j" && i > 0 && words[i - 1].text == "tau" && !numbered) {
            column.sensor = true;
            continue;
        }
        foreign = foreign || sense.is(Meaning::foreign) || (sense.is(Meaning::force) && !linear_axis) ||
                  (sense.is(Meaning::part) && column.role == Role::torque) ||
                  (word.text == "d" && of_current);
        column.motor_side = column.motor_side || sense.is(Meaning::motor);
        column.sensor = column.sensor || sense.is(Meaning::sensor);
        filtered = filtered || sense.is(Meaning::filtered);
        if (sense.is(Meaning::reference) || (word.text == "d" && quantity.word < i)) {
            column.reference = true;
        } else if (i != quantity.word && !sense.is(Meaning::current) && !sense.is(Meaning::general) &&
                   !(word.text == "q" && of_current) &&
                   !(sense.role() == Role::time && column.role != Role::time)) {
            left.push_back(word);
        }
    }
    if (object != nullptr && column.unit.empty()) column.unit = object->unit;
    const bool clock = column.role == Role::time;
    if (!clock) column.joint = joint_in_name(left);
    const bool last = !left.empty() && !words.empty() && left.back().text == words.back().text;
    if (last && left.back().text.size() > 1 && !is_digits(left.back().text) &&
        !left.back().sense.is(Meaning::joint))
        column.suffix = left.back().text;
    if (foreign || (clock && !is_clock_name(left))) column.role = Role::other;
    if (column.sensor) column.rank -= 1;
    if (column.motor_side && !column.current) column.rank += 2;
    if (filtered) column.rank += 4;
    // A torque in Nm comes before one in per cent, which is read only to be refused.
    if (parts.bracketed && column.role != Role::other && !usual_unit(parts.unit, column.role))
        column.rank += 8;
    return column;
}

std::span<const Convention> conventions() { return all_conventions; }

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
    follow_conventions(names, columns);
    std::set<std::string> bare_names;
    std::map<Role, std::size_t> measured;
    for (std::size_t c = 0; c < names.size(); ++c) {
        bare_names.insert(columns[c].bare);
        if (!columns[c].reference) ++measured[columns[c].role];
    }
    for (std::size_t c = 0; c < names.size(); ++c) {
        ColumnName& column = columns[c];
        const std::string& bare = column.bare;
        const auto* const symbol = std::ranges::find_if(
            symbols, [&](const Symbol& known) { return known.text == without_number(bare); });
        // Columns that were taken as symbols are no longer what they were, and no rivals of each other.
        const auto has = [&](Role role) {
            return measured[role] > (!column.reference && column.role == role ? 1U : 0U);
        };
        if (symbol == symbols.end() || has(symbol->role)) continue;
        const bool by_unit = !column.unit.empty() && usual_unit(column.unit, symbol->role);
        if (!column.unit.empty() && !by_unit) continue;
        if (column.role == Role::time && !by_unit && !has(Role::time)) continue;
        bool rivalled = false;
        for_each_word(symbol->rivals, [&](std::string_view rival) {
            rivalled = rivalled || bare_names.count(std::string(rival)) > 0;
        });
        if (!column.reference) --measured[column.role];
        column.symbol = symbol->role;
        column.role = rivalled && !by_unit ? Role::other : symbol->role;
        column.suffix.clear();
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
        numberings[key.substr(0, key.find_last_not_of("0123456789") + 1)][name.role].emplace(*number, c);
    }
    for (const auto& [letters, roles] : numberings) {
        for (auto a = roles.begin(); a != roles.end(); ++a) {
            for (auto b = std::next(a); b != roles.end(); ++b) {
                if (!differ(a->second, b->second)) continue;
                const auto [of_a, first] = *a->second.begin();
                const auto [of_b, second] = *b->second.begin();
                const auto& names = known.facts.names;
                return fmt::format(
                    "{} is the first {} and {} the first {}: joints are numbered from {} and from {}; state "
                    "which "
                    "columns are one joint's, with --columns {}={},{}={}",
                    column_label(names, first), role_name(a->first), column_label(names, second),
                    role_name(b->first), of_a, of_b, role_name(a->first), names[first], role_name(b->first),
                    names[second]);
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
    if (std::ranges::none_of(groups, complete) && groups.size() > 1 && !joint_asked) {
        // "motor_torque" and "link_velocity": one joint whose columns are named after different
        // things.
        const auto count = [&](Role role) {
            return std::ranges::count_if(groups, [role](const JointGroup& group) { return group.has(role); });
        };
        // "tau_motor_side" and "tau_sensor" with them: torques of the one joint that moves, to be chosen
        // from.
        const bool numbered = std::ranges::any_of(
            groups, [](const JointGroup& group) { return number_of(group.key).has_value(); });
        if (count(Role::velocity) <= 1 && count(Role::position) <= 1 &&
            (count(Role::torque) <= 1 || !numbered))
            groups = collect_groups(known, true);
    }
    share_torques(groups);
    const bool any_complete = std::ranges::any_of(groups, complete);
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
    const std::vector<std::size_t>& candidates = group.of(role);
    if (candidates.empty()) return std::nullopt;
    const auto cost = [&known](std::size_t c) {
        return known.names[c].rank + (known.names[c].reference ? 100 : 0);
    };
    const int lowest = cost(std::ranges::min(candidates, {}, cost));
    std::vector<std::size_t> best, still;
    for (const std::size_t c : candidates) {
        if (cost(c) != lowest) continue;
        const bool moves = known.facts.sample.empty() || varies(known.facts.sample[c]);
        (moves ? best : still).push_back(c);
    }
    if (best.empty()) best.swap(still);
    // A current is a torque only by a constant that the log does not hold.
    if (best.size() == 1 && known.names[best.front()].current)
        for (const std::size_t c : candidates)
            if (!known.names[c].current && !known.names[c].reference) best.push_back(c);
    if (best.size() > 1) refuse_tie(known, role, best);
    if (!still.empty()) {
        warnings.push_back({"standing column",
                            fmt::format("{} does not change at the start of the log; the {} is taken from "
                                        "{}; --columns {}=NAME decides otherwise",
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

}  // namespace ripplenotch
