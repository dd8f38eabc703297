// SPDX-License-Identifier: MIT
#include "log/columns/units.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <numbers>
#include <set>
#include <utility>

#include "core/text/lower_case.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"

namespace ripplenotch {

namespace {

struct Spelling {
    std::string_view written;  // lower case, without blanks
    std::string_view usual;
};

// Only spellings that do not depend on case; "Nm" and "mNm" are looked up as they stand before this table is
// asked.
constexpr std::array spellings = {
    Spelling{"sec", "s"},
    Spelling{"secs", "s"},
    Spelling{"second", "s"},
    Spelling{"seconds", "s"},
    Spelling{"msec", "ms"},
    Spelling{"millisecond", "ms"},
    Spelling{"milliseconds", "ms"},
    Spelling{"usec", "us"},
    Spelling{"\xc2\xb5s", "us"},
    Spelling{"\xce\xbcs", "us"},
    Spelling{"microseconds", "us"},
    Spelling{"nsec", "ns"},
    Spelling{"nanoseconds", "ns"},
    Spelling{"deg/sec", "deg/s"},
    Spelling{"degs", "deg/s"},
    Spelling{"degps", "deg/s"},
    Spelling{"deg_per_s", "deg/s"},
    Spelling{"deg_per_sec", "deg/s"},
    Spelling{"degpersec", "deg/s"},
    Spelling{"degree/s", "deg/s"},
    Spelling{"degrees/s", "deg/s"},
    Spelling{"deg*s^-1", "deg/s"},
    Spelling{"degs^-1", "deg/s"},
    Spelling{"degs-1", "deg/s"},
    Spelling{"\xc2\xb0/s", "deg/s"},
    Spelling{"\xc2\xb0/sec", "deg/s"},
    Spelling{"grad/s", "deg/s"},
    Spelling{"deg_s", "deg/s"},
    Spelling{"dps", "deg/s"},
    Spelling{"rad/sec", "rad/s"},
    Spelling{"rads", "rad/s"},
    Spelling{"radps", "rad/s"},
    Spelling{"rad_s", "rad/s"},
    Spelling{"rad_per_s", "rad/s"},
    Spelling{"rad_per_sec", "rad/s"},
    Spelling{"radpersec", "rad/s"},
    Spelling{"radian/s", "rad/s"},
    Spelling{"radians/s", "rad/s"},
    Spelling{"rad*s^-1", "rad/s"},
    Spelling{"rads^-1", "rad/s"},
    Spelling{"rads-1", "rad/s"},
    Spelling{"rad.s-1", "rad/s"},
    Spelling{"rad/s", "rad/s"},
    Spelling{"deg/s", "deg/s"},
    Spelling{"rpm", "rpm"},
    Spelling{"u/min", "rpm"},
    Spelling{"1/min", "rpm"},
    Spelling{"rev/min", "rpm"},
    Spelling{"min-1", "rpm"},
    Spelling{"min^-1", "rpm"},
    Spelling{"r/min", "rpm"},
    Spelling{"rps", "rev/s"},
    Spelling{"deg", "deg"},
    Spelling{"degree", "deg"},
    Spelling{"degrees", "deg"},
    Spelling{"\xc2\xb0", "deg"},
    Spelling{"rad", "rad"},
    Spelling{"radian", "rad"},
    Spelling{"radians", "rad"},
    Spelling{"revs", "rev"},
    Spelling{"turns", "turn"},
    Spelling{"n*m", "Nm"},
    Spelling{"n.m", "Nm"},
    Spelling{"n-m", "Nm"},
    Spelling{"n\xc2\xb7m", "Nm"},
    Spelling{"newtonmeter", "Nm"},
    Spelling{"newton_meter", "Nm"},
    Spelling{"newton_meters", "Nm"},
    Spelling{"newtonmeters", "Nm"},
    Spelling{"amp", "A"},
    Spelling{"amps", "A"},
    Spelling{"ampere", "A"},
    Spelling{"amperes", "A"},
    Spelling{"mamp", "mA"},
};

// Units of torque that this tool does not read, at the end of a name without brackets; a column of them is
// not in Nm.
constexpr std::array<std::string_view, 14> unread_units = {"lbf_in", "in_lbf", "lb_in", "in_lb",  "lbf_ft",
                                                           "ft_lbf", "lb_ft",  "ft_lb", "ozf_in", "in_ozf",
                                                           "oz_in",  "in_oz",  "volts", "kgf_cm"};

// Numbers as a drive or a converter has them. What they are in a physical unit is set in the device.
constexpr std::string_view electrical_rpm = "erpm";
constexpr std::array<std::string_view, 26> device_units = {
    electrical_rpm, "count", "counts",    "cnt",        "cnts",        "cts",     "inc",
    "incr",         "incs",  "increment", "increments", "inkremente",  "inkr",    "pulse",
    "pulses",       "ticks", "lsb",       "permille",   "per_mille",   "permill", "promille",
    "percent",      "pct",   "percents",  "%",          "\xe2\x80\xb0"};

std::string lower_without_blanks(std::string_view text) {
    std::string lower = lower_case(text);
    std::erase(lower, ' ');
    return lower;
}

std::string_view without_padding(std::string_view text) {
    while (!text.empty() && (text.front() == ' ' || text.front() == '_')) text.remove_prefix(1);
    while (!text.empty() && (text.back() == ' ' || text.back() == '_')) text.remove_suffix(1);
    return text;
}

constexpr std::array measured_roles = {Role::time, Role::velocity, Role::torque, Role::position};

bool any_role_knows(std::string_view unit) {
    return std::any_of(measured_roles.begin(), measured_roles.end(),
                       [&](Role role) { return role_factor(role, unit).has_value(); });
}

}  // namespace

Dimension dimension_of(Role role) {
    switch (role) {
        case Role::time:
            return Dimension::time;
        case Role::velocity:
            return Dimension::speed;
        case Role::torque:
            return Dimension::torque;
        case Role::position:
            return Dimension::angle;
        case Role::other:
            break;
    }
    return Dimension::none;
}

bool is_current_unit(std::string_view unit) { return unit_factor(Dimension::current, unit).has_value(); }

namespace {

Dimension linear_dimension_of(Role role) {
    return role == Role::velocity   ? Dimension::linear_speed
           : role == Role::torque   ? Dimension::force
           : role == Role::position ? Dimension::length
                                    : Dimension::none;
}

}  // namespace

bool is_linear_unit(Role role, std::string_view unit) {
    const Dimension dimension = linear_dimension_of(role);
    return dimension != Dimension::none && unit_factor(dimension, unit).has_value();
}

std::optional<double> role_factor(Role role, std::string_view unit, const Conversion& conversion) {
    if (role == Role::torque) {
        if (const auto amperes = unit_factor(Dimension::current, unit))
            return *amperes * conversion.nm_per_ampere;
    }
    if (is_linear_unit(role, unit)) {
        const double si = *unit_factor(linear_dimension_of(role), unit);
        return role == Role::torque ? si * conversion.lead_m / (2.0 * std::numbers::pi)
                                    : si * 360.0 / conversion.lead_m;
    }
    return unit_factor(dimension_of(role), unit);
}

std::optional<std::string> usual_unit(std::string_view written, Role role) {
    const std::string_view text = without_padding(written);
    if (text.empty()) return std::nullopt;
    const std::string lower = lower_without_blanks(text);
    if (role == Role::torque && lower == "nm") return "Nm";
    if (role == Role::torque && lower == "mnm") return "mNm";
    for (const Spelling& spelling : spellings) {
        if (lower == spelling.written) return std::string(spelling.usual);
    }
    // What is left depends on case: mNm, Nm, ms, A.
    if (role == Role::other ? any_role_knows(text) : role_factor(role, text).has_value())
        return std::string(text);
    return std::nullopt;
}

NameAndUnit split_unit(std::string_view column_name, bool linear_axis) {
    const std::string_view whole = without_padding(column_name);
    for (const auto& [open, close] : {std::pair{'[', ']'}, std::pair{'(', ')'}}) {
        const std::size_t from = whole.rfind(open);
        if (from == std::string_view::npos || from == 0 || whole.empty() || whole.back() != close) continue;
        const std::string_view inside = without_padding(whole.substr(from + 1, whole.size() - from - 2));
        const bool index = !inside.empty() && std::all_of(inside.begin(), inside.end(), [](unsigned char c) {
            return std::isdigit(c) != 0;
        });
        // An address, as "(P:00A305h)", is no unit.
        if (inside.find(':') != std::string_view::npos)
            return {std::string(without_padding(whole.substr(0, from))), "", false};
        if (!index) return {std::string(without_padding(whole.substr(0, from))), std::string(inside), true};
    }
    // The longest unit that follows an underscore or a blank: "_deg_s" before "_s".
    for (std::size_t at = 1; at < whole.size(); ++at) {
        if (whole[at] != '_' && whole[at] != ' ') continue;
        const std::string_view rest = whole.substr(at + 1);
        if (is_device_unit(rest))  // "_counts_s" before "_s"
            return {std::string(without_padding(whole.substr(0, at))), std::string(rest), true};
        const bool another =
            !linear_axis && (unit_factor(Dimension::length, rest) || unit_factor(Dimension::force, rest));
        if (rest == "nm" || rest == "mnm" || (!another && usual_unit(rest, Role::other))) {
            return {std::string(without_padding(whole.substr(0, at))), std::string(rest), false};
        }
    }
    for (std::size_t at = 1; at < whole.size(); ++at) {
        if (whole[at] != '_' && whole[at] != ' ') continue;
        const std::string_view rest = whole.substr(at + 1);
        const std::string lower = lower_without_blanks(rest);
        if (std::find(unread_units.begin(), unread_units.end(), lower) != unread_units.end())
            return {std::string(without_padding(whole.substr(0, at))), std::string(rest), true};
    }
    return {std::string(whole), "", false};
}

namespace {

// One sentence for all units that nobody stated.
void say_assumed_units(Layout& layout, const ColumnFacts& facts) {
    std::vector<std::string> taken, asked;
    std::vector<std::optional<std::size_t>> columns = {layout.chosen.time};
    for (const JointColumns& joint : layout.all_chosen())
        columns.insert(columns.end(), {joint.velocity, joint.torque, joint.position});
    for (const auto& column : columns) {
        if (!column || !layout.columns[*column].unit_assumed) continue;
        const Column& c = layout.columns[*column];
        taken.push_back(fmt::format("{} as {}", column_label(facts.names, *column), c.unit));
        asked.push_back(fmt::format("--unit {}={}", role_name(c.role), c.unit));
    }
    for (const JointColumns& joint : layout.all_chosen()) {
        if (!joint.torque || !layout.columns[*joint.torque].unit_assumed) continue;
        const Column& torque = layout.columns[*joint.torque];
        layout.assumptions.push_back({fmt::format("unit of {}", column_label(facts.names, *joint.torque)),
                                      torque.unit,
                                      "not stated in the log",
                                      fmt::format("--unit torque={}", torque.unit),
                                      {}});
    }
    if (!taken.empty()) {
        layout.warnings.push_back({"assumed units",
                                   fmt::format("no unit is stated for what is read: took {}; {} settles it",
                                               fmt::join(taken, ", "), fmt::join(asked, " ")),
                                   true});
    }
}

void say_torque_constant(Layout& layout, const ColumnFacts& facts, const ReadOptions& options) {
    const auto torque = layout.chosen.torque;
    if (!torque) return;
    const bool current = is_current_unit(layout.columns[*torque].unit);
    if (current && !options.nm_per_ampere) {
        layout.warnings.push_back(
            {"motor current",
             fmt::format("{} is a motor current: 1 A is taken as 1 Nm, so every torque is in "
                         "amperes; --kt gives the joint's torque constant in Nm/A",
                         column_label(facts.names, *torque)),
             true});
    }
    if (options.lead_m) {
        bool linear = false;
        for (const JointColumns& joint : layout.all_chosen()) {
            for (const auto& column : {joint.velocity, joint.torque, joint.position})
                linear = linear || (column && is_linear_unit(layout.columns[*column].role,
                                                             layout.columns[*column].unit));
        }
        if (linear)
            layout.inferences.push_back(
                {"linear axis",
                 "angles, speeds and torques of its screw",
                 fmt::format("one turn is {} mm (--lead)", shortest(1e3 * *options.lead_m)),
                 "",
                 {}});
        else
            layout.warnings.push_back(
                {"--lead", "--lead has no effect: nothing that is read is in m, m/s or N", true});
    }
    if (!current && options.nm_per_ampere) {
        layout.warnings.push_back(
            {"--kt",
             fmt::format("--kt has no effect: {} is in {}", column_label(facts.names, *torque),
                         layout.columns[*torque].unit),
             true});
    }
}

void require_used(const Layout& layout, std::string_view option, const std::string& key) {
    for (const Role role : {Role::time, Role::velocity, Role::torque, Role::position}) {
        if (key == role_name(role)) return;
    }
    for (const Column& column : layout.columns) {
        if (column.name == key) return;
    }
    raise<UsageError>("{}: '{}' is neither a role (time, velocity, torque, position) nor a column of {}",
                      option, key, layout.source);
}

}  // namespace

std::optional<std::string> asked_unit(const ReadOptions& options, const std::string& name, Role role) {
    for (const std::string& key : {name, std::string(role_name(role))}) {
        if (const auto found = options.units.find(key); found != options.units.end()) return found->second;
    }
    return std::nullopt;
}

const ColumnScale* asked_scale(const ReadOptions& options, const std::string& name, Role role) {
    for (const std::string& key : {name, std::string(role_name(role))})
        if (const auto found = options.scales.find(key); found != options.scales.end()) return &found->second;
    return nullptr;
}

ColumnScale parse_scale(std::string_view text, std::string_view label) {
    ColumnScale scale;
    scale.text = text;
    const auto complain = [&](std::string_view why) {
        raise<UsageError>(
            "{}: '{}': {}; write FACTOR and UNIT, then /DIVISOR, then +OFFSET, as in 0.04Nm, "
            "360deg/524288 or 2Nm+10Nm",
            label, text, why);
    };
    // The longest beginning that is a number; what follows it is left.
    const auto take_number = [](std::string_view& rest) -> std::optional<double> {
        for (std::size_t size = rest.find_first_not_of("0123456789.eE+-") == std::string_view::npos
                                    ? rest.size()
                                    : rest.find_first_not_of("0123456789.eE+-");
             size > 0; --size) {
            if (const auto number = parse_number(rest.substr(0, size))) {
                rest.remove_prefix(size);
                return number;
            }
        }
        return std::nullopt;
    };
    std::string_view rest = text;
    const auto factor = take_number(rest);
    if (!factor || *factor == 0.0) complain("it does not begin with a number that is not 0");
    scale.factor = *factor;
    // Units have letters behind their '/', a divisor has digits.
    std::size_t end = 0;
    while (end < rest.size() && rest[end] != '+' && rest[end] != '-' &&
           !(rest[end] == '/' && end + 1 < rest.size() &&
             std::isdigit(static_cast<unsigned char>(rest[end + 1])) != 0))
        ++end;
    scale.unit = without_padding(rest.substr(0, end));
    rest.remove_prefix(end);
    if (scale.unit.empty()) complain("no unit follows the number");
    if (rest.starts_with('/')) {
        rest.remove_prefix(1);
        const auto divisor = take_number(rest);
        if (!divisor || *divisor == 0.0) complain("no number follows the '/'");
        scale.factor /= *divisor;
    }
    if (rest.empty()) return scale;
    const auto offset = take_number(rest);
    if (!offset || !(rest.empty() || without_padding(rest) == scale.unit))
        complain("what follows is no offset in the same unit");
    scale.offset = *offset;
    return scale;
}

bool is_device_unit(std::string_view written) {
    std::string unit = lower_without_blanks(without_padding(written));
    for (const std::string_view rate : {"/s", "_s", "/sec", "_per_s"})
        if (unit.ends_with(rate)) unit.resize(unit.size() - rate.size());
    return std::find(device_units.begin(), device_units.end(), unit) != device_units.end();
}

bool counts_only(const std::vector<double>& values) {
    constexpr std::size_t fewest = 64, most_steps = 4096;  // by hand
    std::set<double> different, steps;
    std::optional<double> before;
    for (const double value : values) {
        if (!std::isfinite(value)) continue;
        if (value != std::floor(value)) return false;
        if (different.size() < fewest) different.insert(value);
        if (before && value != *before && steps.size() < most_steps) steps.insert(value - *before);
        before = value;
    }
    const bool rounded =
        std::any_of(steps.begin(), steps.end(), [&](double step) { return steps.count(step + 1.0) > 0; });
    return different.size() >= fewest && rounded;
}

std::string scale_example(Role role, std::string_view device_unit) {
    // Electrical turns: as many to one of the rotor as it has pairs of poles.
    if (device_unit == electrical_rpm) return "--scale velocity=1rpm/7 for 7 pole pairs";
    constexpr std::array examples = {
        std::pair{Role::velocity, "velocity=360deg/s/524288"}, std::pair{Role::torque, "torque=0.04Nm"},
        std::pair{Role::position, "position=360deg/524288"}, std::pair{Role::time, "time=1us"}};
    for (const auto& [known, example] : examples)
        if (known == role) return fmt::format("--scale {}", example);
    return "";
}

std::string unit_list(Role role) {
    std::string list = fmt::format("{}", fmt::join(unit_names(dimension_of(role)), ", "));
    if (role == Role::torque) list += ", A, mA";
    const Dimension linear = linear_dimension_of(role);
    return linear == Dimension::none
               ? list
               : fmt::format("{}; of a linear axis {}", list, fmt::join(unit_names(linear), ", "));
}

void state_units(Layout& layout, const ColumnFacts& facts, const ReadOptions& options) {
    say_assumed_units(layout, facts);
    for (const auto& [key, unit] : options.units) require_used(layout, "--unit", key);
    for (const auto& [key, scale] : options.scales) require_used(layout, "--scale", key);
    say_torque_constant(layout, facts, options);
}

void state_derived_velocity(Layout& layout, const ColumnFacts& facts) {
    if (!layout.chosen.time && !layout.stated_rate) return;
    for (const JointColumns& joint : layout.all_chosen()) {
        if (joint.velocity || !joint.position) continue;
        const std::string label = column_label(facts.names, *joint.position);
        layout.velocity_from_position = true;
        layout.warnings.push_back(
            {"derived velocity",
             fmt::format(
                 "no velocity is logged: it is the slope of {}, from row to row; --columns velocity=NAME "
                 "decides otherwise",
                 label),
             true});
        layout.inferences.push_back({"velocity",
                                     fmt::format("the slope of {}", label),
                                     "no column is a velocity",
                                     "--columns velocity=NAME",
                                     {}});
    }
}

}  // namespace ripplenotch
