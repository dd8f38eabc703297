// SPDX-License-Identifier: MIT
#include "log/columns/decide_layout.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <set>
#include <span>

#include "log/columns/column_name.hpp"
#include "log/columns/infer_motion.hpp"
#include "log/columns/units.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/spec.hpp"

namespace ripplenotch {

// --columns: by place "time,velocity,torque" ("-" skips one), or by name "torque=tau_J" or number "torque=3".

std::string column_label(const std::vector<std::string>& names, std::size_t column) {
    if (names.empty() || names[column].empty()) return fmt::format("column {}", column + 1);
    return fmt::format("'{}' (column {})", names[column], column + 1);
}

std::string asked_role(const ReadOptions& options, std::string_view path) {
    for (const std::string& entry : options.columns) {
        const std::size_t equals = entry.find('=');
        if (equals != std::string::npos && entry.substr(equals + 1) == path) return entry.substr(0, equals);
    }
    return {};
}

namespace {

std::optional<Role> role_of(std::string_view word) {
    for (const Role role : {Role::time, Role::velocity, Role::torque, Role::position}) {
        if (role_name(role) == word) return role;
    }
    return std::nullopt;
}

std::string names_in_words(const ColumnFacts& facts) {
    return facts.names.empty() ? fmt::format("{} columns without names", facts.columns)
                               : fmt::format("{}", fmt::join(facts.names, ", "));
}

std::size_t column_named(const std::string& source, const ColumnFacts& facts, const std::string& name) {
    std::vector<std::size_t> found;
    for (std::size_t c = 0; c < facts.names.size(); ++c) {
        if (facts.names[c] == name) found.push_back(c);
    }
    if (found.size() == 1) return found.front();
    if (found.size() > 1) {
        raise<DataError>(
            "{}: the name '{}' of --columns stands over columns {} and {}; give the number instead, as in "
            "torque={}",
            source, name, found[0] + 1, found[1] + 1, found[0] + 1);
    }
    std::string_view digits = name;
    if (digits.substr(0, 7) == "column ") digits.remove_prefix(7);
    if (const auto number = parse_number(digits);
        number && *number >= 1.0 && *number <= static_cast<double>(facts.columns) &&
        *number == static_cast<double>(static_cast<std::size_t>(*number))) {
        return static_cast<std::size_t>(*number) - 1;
    }
    raise<UsageError>("--columns: {} has no column '{}'; it has {}", source, name, names_in_words(facts));
}

Forced read_columns_option(const std::string& source, const ColumnFacts& facts, const ReadOptions& options) {
    Forced forced;
    forced.roles.resize(facts.columns);
    std::size_t place = 0;
    for (const std::string& entry : options.columns) {
        const std::size_t equals = entry.find('=');
        const std::string word = entry.substr(0, equals);
        const auto role = role_of(word);
        if (!role && word != "-") {
            raise<UsageError>(
                "--columns: '{}' is none of time, velocity, torque, position, or - to skip a column", word);
        }
        if (role && forced.column_of(*role)) raise<UsageError>("--columns: '{}' is given twice", word);
        if (equals != std::string::npos) {
            forced.roles[column_named(source, facts, entry.substr(equals + 1))] = role.value_or(Role::other);
            continue;
        }
        forced.by_place = true;
        if (place >= facts.columns) {
            raise<UsageError>("--columns: names {} columns, {} has {}", options.columns.size(), source,
                              facts.columns);
        }
        forced.roles[place++] = role ? *role : Role::other;
    }
    if (forced.by_place) {
        for (auto& role : forced.roles) {
            if (!role) role = Role::other;
        }
    }
    return forced;
}

// Why a column or a joint of a log is not read, as `info -v` and warnings say it.

std::string what_is_missing(const JointGroup& joint) {
    if (!joint.has(Role::torque)) return "it has no torque";
    return joint.has(Role::position) ? "it has no velocity" : "it has neither velocity nor position";
}

bool holds(const JointGroup& joint, Role role, std::size_t column) {
    return std::ranges::count(joint.of(role), column) > 0;
}

std::string why_unused(const KnownColumns& known, std::size_t column, const std::vector<JointGroup>& joints,
                       const std::vector<JointGroup>& incomplete) {
    const ColumnName& name = known.names[column];
    if (known.forced.roles[column]) return "skipped by --columns";
    if (known.facts.names.empty()) return "it has no name";
    const std::string_view role = role_name(name.role);
    if (name.role == Role::other)
        return name.symbol == Role::other
                   ? "its name is none of a time, velocity, torque or position"
                   : fmt::format("it may be a {} or something else", role_name(name.symbol));
    if (name.reference) return fmt::format("a {} that is a wish or a model, not measured", role);
    if (!name.unit.empty() && !usual_unit(name.unit, name.role))
        return fmt::format("a {} in '{}', which is no unit that is read", role, name.unit);
    if (name.role == Role::time) return "another column is the time";
    if (known.forced.column_of(name.role)) return fmt::format("--columns names the {}", role);
    for (const JointGroup& joint : incomplete)
        if (holds(joint, name.role, column))
            return fmt::format("the {} of {}: {}", role,
                               joint.name.empty() ? "a joint without name" : joint.name,
                               what_is_missing(joint));
    const bool rivalled = std::ranges::any_of(joints, [&](const JointGroup& joint) {
        return holds(joint, name.role, column) && joint.of(name.role).size() > 1;
    });
    return rivalled ? fmt::format("another column is the {} by its name", role)
                    : fmt::format("a {} of no joint that is read", role);
}

// --joint: which joints of a log are meant by names, numbers, lists and ranges.

using Joints = std::vector<std::string>;

/// What stands before the number at the end of a name, "panda_joint" of "panda_joint3".
std::string_view letters_of(std::string_view name) {
    return name.substr(0, name.find_last_not_of("0123456789") + 1);
}

/// By its name, else by "3", "j3" or "joint3" for each other, else by the number that its name ends in.
std::optional<std::size_t> place_of(const Joints& joints, const std::string& word) {
    const auto place = [&](Joints::const_iterator at) {
        const auto number = static_cast<std::size_t>(at - joints.begin());
        return at == joints.end() ? std::nullopt : std::optional(number);
    };
    if (const auto named = place(std::ranges::find(joints, word)); named || word.empty()) return named;
    if (const auto alike = place(std::ranges::find(joints, joint_key(word), joint_key))) return alike;
    const auto ends_in_it = [&](const std::string& joint) {
        return letters_of(joint).size() + word.size() == joint.size() && joint.ends_with(word);
    };
    if (!is_digits(word) || std::ranges::count_if(joints, ends_in_it) != 1) return std::nullopt;
    return place(std::ranges::find_if(joints, ends_in_it));
}

/// Both ends of "j1-j3". A name that holds a hyphen may be one, so that each hyphen is tried.
std::optional<std::pair<std::size_t, std::size_t>> range_of(const Joints& joints, const std::string& entry) {
    for (std::size_t dash = entry.find('-'); dash != std::string::npos; dash = entry.find('-', dash + 1)) {
        const auto first = place_of(joints, entry.substr(0, dash)),
                   last = place_of(joints, entry.substr(dash + 1));
        if (first && last) return std::pair(*first, *last);
    }
    return std::nullopt;
}

[[noreturn]] void refuse(const std::string& source, const std::string& asked, const std::string& entry,
                         const Joints& joints) {
    if (joints.size() == 1 && joints[0].empty())
        raise<UsageError>("--joint {}: {} holds one joint without a name; leave --joint out", asked, source);
    if (joints.empty()) raise<UsageError>("--joint {}: {} has none with velocity and torque", asked, source);
    raise<UsageError>(
        "--joint {}: {} has no joint '{}'; it has {} (names, numbers and ranges: --joint {})", asked, source,
        entry, fmt::join(joints, ", "),
        joints.size() < 3 ? joints.front() : fmt::format("{},{}-{}", joints[0], joints[1], joints.back()));
}

// The joints of `joints`, in their order, that --joint asks for: "all", or names, numbers and ranges with
// commas between them, "j1,j3-j5". Throws UsageError, with the joints that there are.
std::vector<std::string> select_joints(const std::string& source, const std::string& asked,
                                       const std::vector<std::string>& joints) {
    std::vector<bool> taken(joints.size());
    // Numbered joints are counted by their numbers, whatever the order of their columns; others by the order
    // of the log.
    const auto take_between = [&](const std::string& entry, std::size_t first, std::size_t last) {
        const std::string_view letters = letters_of(joints[first]);
        const auto number = [&](std::size_t j) {
            return parse_number(std::string_view(joints[j]).substr(letters.size()));
        };
        const bool numbered = letters == letters_of(joints[last]) && number(first) && number(last);
        if (numbered ? *number(first) > *number(last) : first > last)
            raise<UsageError>("--joint {}: '{}' runs backwards; {} has {}", asked, entry, source,
                              fmt::join(joints, ", "));
        for (std::size_t j = 0; j < joints.size(); ++j) {
            const bool between = numbered ? letters_of(joints[j]) == letters && number(j) &&
                                                *number(j) >= *number(first) && *number(j) <= *number(last)
                                          : j >= first && j <= last;
            if (between) taken[j] = true;
        }
    };
    const auto take = [&](const std::string& entry) {
        if (entry == "all")
            taken.assign(joints.size(), true);
        else if (const auto one = place_of(joints, entry))
            taken[*one] = true;
        else if (const auto range = range_of(joints, entry))
            take_between(entry, range->first, range->second);
        else
            refuse(source, asked, entry, joints);
    };
    // A name may hold a comma or a hyphen itself.
    if (place_of(joints, asked))
        take(asked);
    else
        for (const std::string_view entry : split(asked, ',')) take(std::string(entry));
    std::vector<std::string> selected;
    for (std::size_t j = 0; j < joints.size(); ++j)
        if (taken[j]) selected.push_back(joints[j]);
    return selected;
}

// The option line that would force a reading, ready to paste: what was decided, in the words the user would
// have used.

// A name that --columns can carry, else the column's number.
std::string handle(const ColumnFacts& facts, std::size_t column) {
    if (facts.names.empty() || facts.names[column].empty()) return std::to_string(column + 1);
    const std::string& name = facts.names[column];
    const bool awkward =
        name.find_first_of(",=") != std::string::npos || std::ranges::count(facts.names, name) > 1;
    return awkward ? std::to_string(column + 1) : name;
}

std::string quoted(const std::string& word) {
    if (word.find_first_of(" \t;'\"()[]*&|<>$#") == std::string::npos) return word;
    std::string out = "'";
    for (const char c : word) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return out + "'";
}

std::string options_line(const Layout& layout, const ColumnFacts& facts, const ReadOptions& options) {
    std::vector<std::string> words = {"--format " + layout.format};
    if (!facts.dialect_options.empty()) words.push_back(facts.dialect_options);
    std::vector<std::string> columns, units;
    for (const auto& column :
         {layout.chosen.time, layout.chosen.velocity, layout.chosen.torque, layout.chosen.position}) {
        if (!column) continue;
        const Column& c = layout.columns[*column];
        columns.push_back(fmt::format("{}={}", role_name(c.role), handle(facts, *column)));
        units.push_back(c.scale.empty()
                            ? "--unit " + quoted(fmt::format("{}={}", role_name(c.role), c.unit))
                            : "--scale " + quoted(fmt::format("{}={}", role_name(c.role), c.scale)));
    }
    std::vector<std::string> sides;
    for (const auto& column : {layout.chosen.velocity, layout.chosen.position}) {
        if (column && layout.columns[*column].side == Shaft::motor)
            sides.push_back(fmt::format("{}=motor", role_name(layout.columns[*column].role)));
    }
    if (!columns.empty()) words.push_back("--columns " + quoted(fmt::format("{}", fmt::join(columns, ","))));
    words.insert(words.end(), units.begin(), units.end());
    if (!sides.empty()) words.push_back(fmt::format("--side {}", fmt::join(sides, ",")));
    if (!layout.chosen.joint.empty()) words.push_back("--joint " + quoted(layout.chosen.joint));
    if (layout.stated_rate) words.push_back("--sample-rate " + shortest(layout.stated_rate->value()) + "Hz");
    if (options.constant_speed)
        words.push_back("--constant-speed " + shortest(options.constant_speed->value()) + "deg/s");
    if (options.nm_per_ampere) words.push_back("--kt " + shortest(*options.nm_per_ampere));
    if (options.lead_m) words.push_back("--lead " + shortest(1e3 * *options.lead_m) + "mm");
    if (options.skip_lines > 0) words.push_back(fmt::format("--skip-lines {}", options.skip_lines));
    if (options.hold_bad_values) words.push_back("--hold-bad-values");
    return fmt::format("{}", fmt::join(words, " "));
}

class Decision {
  public:
    Decision(const std::string& source, const ColumnFacts& facts, const ReadOptions& options)
        : source_(source),
          facts_(facts),
          options_(options),
          forced_(read_columns_option(source, facts, options)),
          stated_(facts.columns) {}

    Layout run(const std::string& format) {
        layout_.source = source_;
        layout_.format = format;
        layout_.stated_rate = options_.sample_rate;
        name_columns();
        choose_time(facts_, names_, forced_, options_, layout_);
        if (layout_.chosen.time) give_role(*layout_.chosen.time, Role::time, "");
        if (layout_.time_fraction) give_role(*layout_.time_fraction, Role::time, "");
        settle_clock(facts_, layout_.chosen.time && stated_[*layout_.chosen.time], layout_);
        compare_numberings();
        groups_ = group_joints(known(), options_.joint && *options_.joint != "all",
                               !options_.every_joint || options_.torque_of_each, incomplete_);
        for (const JointGroup& group : groups_) layout_.joints.push_back(group.name);
        take_asked();
        if (options_.each_joint && layout_.asked.size() > 1) return each_alone();
        choose_joint();
        settle();
        return std::move(layout_);
    }

  private:
    // Once the columns that are read are chosen.
    void settle() {
        refuse_unscaled();
        infer_motion(facts_, options_, motions_of(known(), groups_, stated_, options_, layout_), evidence_,
                     layout_);
        state_derived_velocity(layout_, facts_);
        take_constant_speed();
        state_symbols();
        state_units(layout_, facts_, options_);
        for (std::size_t c = 0; c < facts_.columns; ++c) {
            Column& column = layout_.columns[c];
            if (column.role != Role::other) continue;
            column.unit = names_[c].unit;
            column.unused = why_unused(known(), c, groups_, incomplete_);
        }
        report_repeated_names();
        layout_.options = options_line(layout_, facts_, options_);
    }

    // What all joints share is decided once.
    Layout each_alone() {
        const Layout file = layout_;
        const std::vector<bool> stated = stated_;
        std::vector<Layout> each;
        for (const std::string& joint : file.asked) {
            layout_ = file;
            layout_.asked = {joint};
            layout_.left_out.clear();
            stated_ = stated;
            linear_.clear();
            unscaled_.clear();
            choose(group_named(joint));
            settle();
            each.push_back(layout_);
        }
        Layout all = each.front();
        all.asked = file.asked;
        all.left_out = file.left_out;
        for (const Layout& one : std::span(each).subspan(1)) {
            all.others.push_back(one.chosen);
            all.velocity_from_position = all.velocity_from_position || one.velocity_from_position;
            for (const std::size_t column : one.columns_read()) all.columns[column] = one.columns[column];
        }
        all.each = std::move(each);
        return all;
    }

    void name_columns() {
        if (facts_.names.empty())
            names_.resize(facts_.columns);
        else
            names_ = read_column_names(facts_.meanings(), facts_.units);
        for (std::size_t c = 0; c < facts_.columns; ++c) {
            layout_.columns.emplace_back().name =
                facts_.names.empty() ? fmt::format("column {}", c + 1) : facts_.names[c];
            if (names_[c].unit.empty() && facts_.names.empty() && !facts_.units.empty()) {
                names_[c].unit = facts_.units[c];
                names_[c].unit_is_sure = !facts_.units[c].empty();
            }
            if (forced_.roles[c]) {
                names_[c].role = *forced_.roles[c];
                names_[c].reference = false;
                names_[c].rank = 0;
                names_[c].current = names_[c].current || is_current_unit(names_[c].unit);
            }
        }
    }

    void compare_numberings() {
        const std::string mixed = mixed_numberings(known());
        if (mixed.empty()) return;
        if (options_.needs_torque) raise<DataError>("{}: {}", source_, mixed);
        layout_.warn("numbering of joints", mixed);
    }

    // Joints without a torque or without a motion can be named, and are left out with the reason.
    void take_asked() {
        std::vector<std::string> names = layout_.joints;
        for (const JointGroup& group : incomplete_) names.push_back(group.name);
        const std::vector<std::string> asked =
            options_.joint ? select_joints(source_, *options_.joint, names) : names;
        for (const std::string& joint : asked) {
            const auto lacking = std::ranges::find_if(
                incomplete_, [&](const JointGroup& group) { return group.name == joint; });
            if (lacking == incomplete_.end())
                layout_.asked.push_back(joint);
            else
                layout_.left_out.push_back({joint, what_is_missing(*lacking)});
        }
        if (layout_.asked.empty() && !layout_.left_out.empty())
            raise<UsageError>("--joint {}: {}: joint {}: {}; those that have torque and motion are {}",
                              *options_.joint, source_, layout_.left_out.front().joint,
                              layout_.left_out.front().why, fmt::join(layout_.joints, ", "));
    }

    void choose_joint() {
        const JointGroup* group = nullptr;
        if (layout_.asked.size() == 1) {
            group = group_named(layout_.asked.front());
        } else if (groups_.size() > 1 && !options_.joint && forced_.column_of(Role::torque)) {
            const std::string key = joint_key(names_[*forced_.column_of(Role::torque)].joint);
            for (const JointGroup& candidate : groups_) {
                if (candidate.key == key) group = &candidate;
            }
            if (group != nullptr) layout_.asked = {group->name};
        }
        // One that is asked for by its name is read as by a reader of one.
        if (options_.every_joint &&
            (!options_.joint || layout_.asked.size() != 1 || *options_.joint == "all")) {
            choose_every_joint();
            return;
        }
        if (group == nullptr && layout_.asked.size() > 1 && options_.needs_torque) {
            raise<DataError>(
                "{}: read {} joints ({}), expected one; select one with --joint {}, or --joint all where the "
                "command takes several",
                source_, layout_.asked.size(), fmt::join(layout_.asked, ", "), layout_.asked.front());
        }
        choose(group);
    }

    // Of a joint that is read, only the columns that are; null for none.
    void choose(const JointGroup* group) {
        if (group != nullptr) layout_.chosen = columns_of(*group);
        for (const JointGroup& each : groups_) give_roles(each, &each == group ? &layout_.chosen : nullptr);
        if (options_.needs_torque) require_torque_and_velocity();
    }

    // What letters were taken for, and what they were not taken for because they may mean something else.
    void state_symbols() {
        for (const JointColumns& joint : layout_.all_chosen()) {
            for (const Role role : motion_roles) {
                const auto column = joint.of(role);
                if (!column || names_[*column].symbol != role || forced_.roles[*column]) continue;
                layout_.infer(std::string(role_name(role)), column_label(facts_.names, *column),
                              "a symbol of it, and no other column is one",
                              fmt::format("--columns {}=NAME", role_name(role)));
            }
        }
        for (const Role role : motion_roles) {
            const std::string perhaps = maybe(role);
            if (perhaps.empty() || forced_.column_of(role)) continue;
            layout_.warn("symbols", fmt::format("{} is not read: {}", role_name(role), perhaps));
        }
    }

    std::string maybe(Role role) const {
        for (std::size_t c = 0; c < names_.size(); ++c) {
            if (names_[c].symbol == role && names_[c].role == Role::other && !forced_.roles[c])
                return fmt::format("{} may be the {}, or something else; --columns {}={} takes it",
                                   column_label(facts_.names, c), role_name(role), role_name(role),
                                   facts_.names[c]);
        }
        return "";
    }

    // At the joint, as all motion is from here on.
    void take_constant_speed() {
        if (!options_.constant_speed) return;
        if (layout_.chosen.velocity || layout_.velocity_from_position)
            raise<UsageError>("--constant-speed: {} itself states how the joint moves; leave it out",
                              source_);
        const auto side = options_.sides.find(Role::velocity);
        const bool motor = side != options_.sides.end() && side->second == Shaft::motor;
        if (motor && !options_.gear_ratio)
            raise<UsageError>("--constant-speed of the motor needs --gear-ratio, for example 100");
        layout_.constant_speed = *options_.constant_speed / (motor ? *options_.gear_ratio : 1.0);
        layout_.infer("velocity",
                      fmt::format("{} deg/s throughout", shortest(layout_.constant_speed->value())),
                      "no motion is logged, and --constant-speed states it", "--columns velocity=NAME");
    }

    // The slope of a position needs times.
    bool may_derive(const JointColumns& joint) const {
        return joint.position && (layout_.chosen.time || layout_.stated_rate);
    }

    bool may_go_without(const JointColumns& joint) const {
        return may_derive(joint) || options_.constant_speed || !options_.needs_velocity;
    }

    KnownColumns known() const { return {source_, facts_, forced_, names_}; }

    JointColumns columns_of(const JointGroup& group) {
        JointColumns columns{group.name, layout_.chosen.time, {}, {}, {}};
        for (const Role role : motion_roles)
            columns.of(role) = choose_column(known(), group, role, layout_.warnings);
        return columns;
    }

    const JointGroup* group_named(const std::string& name) const {
        const auto at =
            std::ranges::find_if(groups_, [&](const JointGroup& group) { return group.name == name; });
        return at == groups_.end() ? nullptr : &*at;
    }

    bool caller_takes(const std::string& joint) {
        if (!options_.check_joint) return true;
        try {
            options_.check_joint(joint);
            return true;
        } catch (const Error& error) {
            if (!refusal_) refusal_ = std::current_exception();
            layout_.left_out.push_back({joint, error.what()});
            return false;
        }
    }

    // Joints without a velocity or without a torque have nothing to be filtered.
    void choose_every_joint() {
        for (const Role role : motion_roles) {
            if (!forced_.column_of(role) || layout_.asked.size() < 2) continue;
            raise<UsageError>("--joint all: --columns names one joint's {}; leave one of the two out",
                              role_name(role));
        }
        std::vector<const JointGroup*> groups;
        for (const std::string& joint : layout_.asked) {
            const JointGroup& group = *group_named(joint);
            const JointColumns columns = columns_of(group);
            const bool moves = columns.velocity || may_go_without(columns);
            const bool bears = columns.torque || !options_.torque_of_each;
            if (!moves || !bears) {
                layout_.left_out.push_back({joint, what_is_missing(group)});
                continue;
            }
            if (!caller_takes(joint)) continue;
            groups.push_back(&group);
            (groups.size() == 1 ? layout_.chosen : layout_.others.emplace_back()) = columns;
        }
        if (groups.empty() && refusal_) std::rethrow_exception(refusal_);
        for (const JointGroup& group : groups_) {
            const auto place = std::ranges::find(groups, &group) - groups.begin();
            const auto number = static_cast<std::size_t>(place);
            give_roles(group, number == groups.size() ? nullptr
                              : number == 0           ? &layout_.chosen
                                                      : &layout_.others[number - 1]);
        }
        require_torque_and_velocity();
    }

    void give_roles(const JointGroup& group, const JointColumns* chosen) {
        for (const Role role : motion_roles) {
            if (chosen != nullptr) {
                if (const auto column = chosen->of(role)) give_role(*column, role, group.name);
                continue;
            }
            for (const std::size_t c : group.of(role))
                if (!names_[c].reference) give_role(c, role, group.name);
        }
    }

    void require_torque_and_velocity() const {
        const std::string names = names_in_words(facts_).substr(0, 400);
        for (const auto& [column, role] : {std::pair{layout_.chosen.torque, Role::torque},
                                           std::pair{layout_.chosen.velocity, Role::velocity}}) {
            if (column || (role == Role::velocity && may_go_without(layout_.chosen))) continue;
            if (role == Role::torque && options_.every_joint && !options_.torque_of_each) continue;
            const std::string perhaps = maybe(role);
            raise<DataError>(
                "{}: read {}{}, expected a {} column; {}state which it is, with --columns {}{}", source_,
                names, facts_.left_out, role_name(role), perhaps.empty() ? "" : perhaps + "; ",
                facts_.names.empty() ? "time,velocity,torque" : fmt::format("{}=NAME", role_name(role)),
                role == Role::velocity ? "; or how fast the joint turns, with --constant-speed 60rpm" : "");
        }
    }

    // The unit that --unit or --scale states; empty where neither does.
    std::string unit_of_options(std::size_t c, Role role, const ColumnScale* scale) const {
        const std::string* const asked = stated_of(options_.units, layout_.columns[c].name, role);
        if (asked == nullptr && scale == nullptr) return "";
        const auto usual = usual_unit(asked != nullptr ? *asked : scale->unit, role);
        const bool fits = usual && role_factor(role, *usual);
        if (asked != nullptr && !fits)
            raise<UsageError>("--unit: '{}' is no unit of {}; write one of {}", *asked, role_name(role),
                              unit_list(role));
        if (asked != nullptr && scale != nullptr)
            raise<UsageError>("--scale and --unit both state the unit of {}; leave one out",
                              column_label(facts_.names, c));
        if (!fits || (asked == nullptr && role == Role::time && scale->offset != 0.0))
            raise<UsageError>("--scale: '{}' is no {}; write its unit as one of {}{}", scale->text,
                              role_name(role), unit_list(role),
                              role == Role::time ? ", without an offset" : "");
        return *usual;
    }

    void give_role(std::size_t c, Role role, const std::string& joint) {
        Column& column = layout_.columns[c];
        column.role = role;
        column.joint = joint;
        std::string written = names_[c].unit;
        const Convention* const known = names_[c].convention(role);
        const bool device = known != nullptr && is_device_unit(known->unit);
        if (written.empty() && device) written = known->unit;
        stated_[c] = !written.empty();
        const ColumnScale* const scale = stated_of(options_.scales, column.name, role);
        if (const std::string unit = unit_of_options(c, role, scale); !unit.empty()) {
            written = unit;
            stated_[c] = true;
            if (scale != nullptr) column.scale = scale->text;
        } else if (is_chosen(c)) {
            ask_for_scale(c, role, written, known);
        }
        if (const auto unit = usual_unit(written, role);
            unit && is_linear_unit(role, *unit) && is_chosen(c) && !options_.lead_m)
            linear_.push_back(fmt::format("{} in {}", column_label(facts_.names, c), *unit));
        const bool unknown = !written.empty() && !usual_unit(written, role);
        if (unknown && !is_device_unit(written) && !is_chosen(c)) {
            column.role = Role::other;
            column.joint.clear();
            return;
        }
        if (unknown) written.clear(), stated_[c] = false;
        if (written.empty()) {
            const bool by_convention = known != nullptr && !device;
            column.unit_assumed = !by_convention;
            written = by_convention ? std::string(known->unit)
                      : role == Role::torque && names_[c].current
                          ? "A"
                          : std::string(base_unit(dimension_of(role)));
            stated_[c] = by_convention && role == Role::time;
        }
        column.unit = *usual_unit(written, role);
        const double factor = *role_factor(
            role, column.unit, {options_.nm_per_ampere.value_or(1.0), options_.lead_m.value_or(1.0)});
        column.factor = factor * (scale != nullptr ? scale->factor : 1.0);
        column.shift = factor * (scale != nullptr ? scale->offset : 0.0);
        column.current = role == Role::torque && is_current_unit(column.unit) && !options_.nm_per_ampere;
        column.unit_assumed = column.unit_assumed && !stated_[c];
    }

    /// Whether another column of the joint has the same words left in its name, which are the joint's then.
    bool shares_joint(std::size_t c) const {
        for (const JointColumns& joint : layout_.all_chosen()) {
            const std::array columns = {joint.velocity, joint.torque, joint.position};
            if (std::ranges::find(columns, c) == columns.end()) continue;
            return std::ranges::any_of(columns, [&](const auto& other) {
                return other && *other != c && joint_key(names_[*other].joint) == joint_key(names_[c].joint);
            });
        }
        return false;
    }

    // Notes what a column lacks to be a quantity.
    void ask_for_scale(std::size_t c, Role role, const std::string& written, const Convention* known) {
        const std::string label = column_label(facts_.names, c);
        if (!facts_.scales.empty() && !facts_.scales[c].words.empty()) {
            const HeadScale& head = facts_.scales[c];
            const auto usual = usual_unit(written, role);
            const std::string unit = usual ? *usual : std::string(base_unit(dimension_of(role)));
            unscaled_.push_back(
                {fmt::format("{} over {}, and not whether the export scaled the values", head.words, label),
                 fmt::format("--scale {}={}{}{} where it did not, --unit {}={} where it did", role_name(role),
                             shortest(head.factor), unit,
                             head.offset == 0.0 ? "" : fmt::format("{:+}{}", head.offset, unit),
                             role_name(role), unit)});
        } else if (is_device_unit(written)) {
            unscaled_.push_back({fmt::format("{} in {}", label, written), scale_example(role, written)});
        } else if (role != Role::time && written.empty() && !names_[c].suffix.empty() && !shares_joint(c)) {
            unscaled_.push_back({fmt::format("{}, where '{}' is neither a unit that is known nor in the name "
                                             "of another column, as a joint is",
                                             label, names_[c].suffix),
                                 unit_or_scale(role)});
        } else if (!written.empty() && !usual_unit(written, role)) {
            unscaled_.push_back(
                {fmt::format("{} in '{}', which is no unit of a {}", label, written, role_name(role)),
                 unit_or_scale(role)});
        } else if (written.empty() && role != Role::time && c < facts_.sample.size() &&
                   counts_only(facts_.sample[c]) && known == nullptr) {
            unscaled_.push_back(
                {fmt::format("{} in whole numbers throughout, as counts are, and no unit", label),
                 unit_or_scale(role)});
        }
    }

    static std::string unit_or_scale(Role role) {
        return fmt::format("{} (or --unit {}={})", scale_example(role), role_name(role),
                           base_unit(dimension_of(role)));
    }

    // All at once: each is one option more.
    void refuse_unscaled() {
        if (!linear_.empty()) {
            const std::string what = fmt::format(
                "read {}, of a linear axis, expected the travel of one turn of its screw; use --lead 5mm, "
                "and results are those of the screw, in deg and Nm; if the header is wrong, --unit states "
                "another unit",
                fmt::join(linear_, ", "));
            if (options_.needs_torque) raise<DataError>("{}: {}", source_, what);
            layout_.warn("linear axis", what, true);
        }
        if (unscaled_.empty()) return;
        std::vector<std::string> read, options;
        for (const auto& [what, option] : unscaled_) {
            read.push_back(what);
            options.push_back(option);
        }
        const std::string what = fmt::format("{}", fmt::join(read, "; ")),
                          say = fmt::format("{}", fmt::join(options, " "));
        if (options_.needs_torque)
            ask("{}: read {}, expected quantities; state what 1 is, as in {}", source_, what, say);
        layout_.warn("unscaled",
                     fmt::format("read {}; commands that use it ask what 1 is, as in {}", what, say), true);
    }

    bool is_chosen(std::size_t c) const {
        const auto holds = [c](const JointColumns& chosen) {
            return chosen.time == c || chosen.velocity == c || chosen.torque == c || chosen.position == c;
        };
        return holds(layout_.chosen) || std::ranges::any_of(layout_.others, holds);
    }

    void report_repeated_names() {
        std::set<std::string> seen, told;
        for (const std::string& name : facts_.names) {
            if (name.empty() || seen.insert(name).second || !told.insert(name).second) continue;
            layout_.warn("repeated names", fmt::format("several columns are named '{}'", name));
        }
    }

    const std::string& source_;
    const ColumnFacts& facts_;
    const ReadOptions& options_;
    Forced forced_;
    Layout layout_;
    std::vector<ColumnName> names_;
    std::vector<bool> stated_;                     ///< by column: the log or an option says its unit
    std::vector<JointGroup> groups_, incomplete_;  ///< those that may be read, and those that lack something
    MotionsSeen evidence_;
    std::exception_ptr refusal_;       ///< the first of the caller
    std::vector<std::string> linear_;  ///< what is read in m, m/s and N where no lead is stated
    std::vector<std::pair<std::string, std::string>>
        unscaled_;  ///< what was read, and the option that says more
};

}  // namespace

std::optional<std::size_t> Forced::column_of(Role role) const {
    const auto at = std::ranges::find(roles, std::optional<Role>(role));
    if (at == roles.end()) return std::nullopt;
    return static_cast<std::size_t>(at - roles.begin());
}

std::string_view role_name(Role role) {
    constexpr std::array<std::string_view, 5> names = {"time", "velocity", "torque", "position", "other"};
    return names[static_cast<std::size_t>(role)];
}

Layout decide_layout(const std::string& source, const std::string& format, const ColumnFacts& facts,
                     const ReadOptions& options) {
    return Decision(source, facts, options).run(format);
}

}  // namespace ripplenotch
