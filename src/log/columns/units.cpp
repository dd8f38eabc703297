// SPDX-License-Identifier: MIT
#include "log/columns/units.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <cctype>
#include <cmath>
#include <numbers>
#include <set>
#include <utility>

#include "core/text/lower_case.hpp"
#include "log/columns/column_name.hpp"
#include "ripplenotch/core/number.hpp"

namespace ripplenotch {

namespace {

struct UnitLine {
    Dimension dimension;
    std::string_view usual, spellings;
};
#define UNIT(dimension, usual, spellings) UnitLine{Dimension::dimension, usual, spellings},
constexpr std::array unit_lines = {
#include "log/columns/names.def"
};

constexpr std::string_view electrical_rpm = "erpm";

/// The usual name of a unit of this dimension, by its spelling alone; for Dimension::none, whether there is
/// one.
std::optional<std::string_view> spelled(Dimension dimension, std::string_view text) {
    for (const UnitLine& line : unit_lines)
        if (line.dimension == dimension && has_word(line.spellings, text)) return line.usual;
    return std::nullopt;
}

std::string without_signs(std::string_view text, std::string_view signs) {
    std::string rest(text);
    std::erase_if(rest, [signs](char c) { return signs.find(c) != std::string_view::npos; });
    return rest;
}

void replace_all(std::string& text, std::string_view what, std::string_view by) {
    for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += by.size())
        text.replace(at, what.size(), by);
}

// In lower case without blanks, with one sign for each meaning: u for micro, . for a product.
std::string normal_spelling(std::string_view text) {
    std::string spelling = without_signs(lower_case(text), " ");
    for (const std::string_view micro : {"\xc2\xb5", "\xce\xbc"}) replace_all(spelling, micro, "u");
    for (const std::string_view times : {"\xc2\xb7", "\xe2\x8b\x85", "\xe2\x88\x99", "*", "\xc3\x97"})
        replace_all(spelling, times, ".");
    return spelling;
}

// A force by a length, in either order and however joined: "N-m", "lbf_ft", "in.lb", "mNm".
std::optional<std::string> torque_unit(std::string_view written) {
    const std::string text = without_signs(normal_spelling(written), "._-");
    for (const auto& [spelling, usual] :
         {std::pair("nm", "Nm"), std::pair("mnm", "mNm"), std::pair("unm", "uNm"), std::pair("cnm", "cNm"),
          std::pair("knm", "kNm")}) {
        // A capital M is mega.
        if (text == spelling && !(written.starts_with('M') && written != "MNM")) return usual;
    }
    for (std::size_t cut = 1; cut < text.size(); ++cut) {
        const std::string_view front = std::string_view(text).substr(0, cut),
                               back = std::string_view(text).substr(cut);
        auto force = spelled(Dimension::force, front), length = spelled(Dimension::length, back);
        if (!force || !length)
            force = spelled(Dimension::force, back), length = spelled(Dimension::length, front);
        if (!force || !length) continue;
        const std::string joined =
            *force == "N" ? fmt::format("N{}", *length) : fmt::format("{}.{}", *force, *length);
        if (unit_factor(Dimension::torque, joined)) return joined;
    }
    return std::nullopt;
}

// An angle by a time, however joined: "deg/s", "rad_per_sec", "rad s^-1", "degps", "U/min".
std::optional<std::string> speed_unit(std::string_view written) {
    std::string text = normal_spelling(written);
    if (text == "rpm" || text == "upm") return "rpm";
    if (text == "rps" || text == "dps") return text == "rps" ? "rev/s" : "deg/s";
    replace_all(text, "_per_", "/");
    replace_all(text, "per", "/");
    std::string angle, time;
    const auto cut_time = [&](std::string_view end, std::string_view unit) {
        if (!time.empty() || !text.ends_with(end)) return;
        time = unit;
        angle = without_signs(text.substr(0, text.size() - end.size()), "._/");
    };
    for (const auto& [end, unit] : {std::pair("s^-1", "s"), std::pair("s-1", "s"), std::pair("min^-1", "min"),
                                    std::pair("min-1", "min"), std::pair("ps", "s")})
        cut_time(end, unit);
    if (const std::size_t bar = text.find_last_of("/_"); time.empty() && bar != std::string::npos) {
        time = spelled(Dimension::time, text.substr(bar + 1)).value_or("");
        angle = without_signs(text.substr(0, bar), ".");
    }
    if (text == "degs" || text == "rads") cut_time("s", "s");
    auto usual = spelled(Dimension::angle, angle);
    const bool turns = angle.empty() || angle == "1" || angle == "u" || angle == "r";
    if (!usual && turns && time == "min") usual = "rev";
    if (!usual || time.empty()) return std::nullopt;
    if (*usual == "rev" && time == "min") return "rpm";
    const std::string joined = fmt::format("{}/{}", *usual, time);
    return unit_factor(Dimension::speed, joined) ? std::optional(joined) : std::nullopt;
}

std::string_view without_padding(std::string_view text) { return trimmed(text, " _,:/-."); }

Dimension linear_dimension_of(Role role) {
    constexpr std::array dimensions = {Dimension::none, Dimension::linear_speed, Dimension::force,
                                       Dimension::length, Dimension::none};
    return dimensions[static_cast<std::size_t>(role)];
}

// One sentence for all units that are not stated.
void say_assumed_units(Layout& layout, const ColumnFacts& facts) {
    std::vector<std::string> taken, asked;
    for (const std::size_t column : layout.columns_read()) {
        const Column& c = layout.columns[column];
        if (!c.unit_assumed) continue;
        taken.push_back(fmt::format("{} as {}", column_label(facts.names, column), c.unit));
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
        layout.warn("assumed units",
                    fmt::format("no unit is stated for what is read: took {}; {} settles it",
                                fmt::join(taken, ", "), fmt::join(asked, " ")),
                    true);
    }
}

void say_torque_constant(Layout& layout, const ColumnFacts& facts, const ReadOptions& options) {
    const auto torque = layout.chosen.torque;
    if (!torque) return;
    const bool current = is_current_unit(layout.columns[*torque].unit);
    if (current && !options.nm_per_ampere) {
        layout.warn("motor current",
                    fmt::format("{} is a motor current: 1 A is taken as 1 Nm, so every torque is in amperes; "
                                "--kt gives the joint's torque constant in Nm/A",
                                column_label(facts.names, *torque)),
                    true);
    }
    if (options.lead_m) {
        const bool linear = std::ranges::any_of(layout.columns_read(), [&](std::size_t c) {
            return is_linear_unit(layout.columns[c].role, layout.columns[c].unit);
        });
        if (linear)
            layout.infer("linear axis", "angles, speeds and torques of its screw",
                         fmt::format("one turn is {} mm (--lead)", shortest(1e3 * *options.lead_m)), "");
        else
            layout.warn("--lead", "--lead has no effect: nothing that is read is in m, m/s or N", true);
    }
    if (!current && options.nm_per_ampere) {
        layout.warn("--kt",
                    fmt::format("--kt has no effect: {} is in {}", column_label(facts.names, *torque),
                                layout.columns[*torque].unit),
                    true);
    }
}

void require_used(const Layout& layout, std::string_view option, const std::string& key) {
    for (const Role role : {Role::time, Role::velocity, Role::torque, Role::position})
        if (key == role_name(role)) return;
    if (std::ranges::find(layout.columns, key, &Column::name) != layout.columns.end()) return;
    raise<UsageError>("{}: '{}' is neither a role (time, velocity, torque, position) nor a column of {}",
                      option, key, layout.source);
}

}  // namespace

Dimension dimension_of(Role role) {
    constexpr std::array dimensions = {Dimension::time, Dimension::speed, Dimension::torque, Dimension::angle,
                                       Dimension::none};
    return dimensions[static_cast<std::size_t>(role)];
}

bool is_current_unit(std::string_view unit) { return unit_factor(Dimension::current, unit).has_value(); }

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
    if (role == Role::other) {
        for (const Role one : {Role::time, Role::velocity, Role::position, Role::torque}) {
            // Without a quantity, letters that stand alone or for two things are meant as they are written.
            const std::string lower = lower_case(text);
            const bool by_case = text.size() == 1 || lower == "nm" || lower == "mnm";
            if (by_case ? role_factor(one, text).has_value() : usual_unit(text, one).has_value())
                return usual_unit(text, one);
        }
        return std::nullopt;
    }
    const std::string spelling = normal_spelling(text);
    std::optional<std::string> found;
    if (role == Role::torque) found = torque_unit(text);
    if (role == Role::velocity) found = speed_unit(text);
    if (!found) {
        const Dimension dimension = role == Role::torque ? Dimension::current : dimension_of(role);
        const auto usual = spelled(dimension, text.size() == 1 ? text : std::string_view(spelling));
        if (usual) found = *usual;
    }
    // What depends on case, and units of a linear axis.
    if (!found && role_factor(role, text)) found = text;
    return found;
}

NameAndUnit split_unit(std::string_view column_name, Role role, bool linear_axis) {
    constexpr std::string_view blanks = " _";
    const std::string_view whole = trimmed(column_name, blanks);
    for (const auto& [open, close] : {std::pair{'[', ']'}, std::pair{'(', ')'}}) {
        const std::size_t from = whole.rfind(open);
        if (from == std::string_view::npos || from == 0 || whole.empty() || whole.back() != close) continue;
        const std::string_view inside = trimmed(whole.substr(from + 1, whole.size() - from - 2), blanks);
        // An address, as "(P:00A305h)", is no unit.
        if (inside.find(':') != std::string_view::npos)
            return {std::string(trimmed(whole.substr(0, from), blanks)), "", false};
        // Nor are words, as in "torque (measured)".
        if (!is_digits(inside) &&
            (usual_unit(inside, role) || is_device_unit(inside) || !is_known_word(inside)))
            return {std::string(trimmed(whole.substr(0, from), blanks)), std::string(inside), true};
    }
    // The longest unit that ends the name: "_deg_s" before "_s", "velDeg", "tau / Nm".
    const auto is_letter = [&](std::size_t at) {
        return std::isalnum(static_cast<unsigned char>(whole[at])) != 0;
    };
    for (std::size_t at = 1; at < whole.size(); ++at) {
        const unsigned char before = static_cast<unsigned char>(whole[at - 1]),
                            here = static_cast<unsigned char>(whole[at]);
        const bool edge = !is_letter(at - 1) && before < 0x80 && before != '^';
        const bool capital = std::islower(before) != 0 && (std::isupper(here) != 0 || here >= 0x80);
        if ((!edge && !capital) || (!is_letter(at) && here < 0x80 && here != '%')) continue;
        const std::string_view rest = whole.substr(at);
        const std::string_view name = without_padding(whole.substr(0, at));
        if (name.empty()) continue;
        if (is_device_unit(rest))  // "_counts_s" before "_s"
            return {std::string(name), std::string(rest), true};
        const bool linear = is_linear_unit(Role::position, rest) || is_linear_unit(Role::torque, rest);
        if ((linear && !linear_axis) || (capital && rest.size() == 1)) continue;
        if (usual_unit(rest, role) || (role == Role::other && (rest == "nm" || rest == "mnm")))
            return {std::string(name), std::string(rest), false};
    }
    return {std::string(whole), "", false};
}

std::optional<double> stated_clock_ns(const std::string& unit, std::string_view name) {
    constexpr double nanoseconds = 1e9;  // in a second
    const auto usual = usual_unit(unit.empty() ? split_unit(name, Role::time).unit : unit, Role::time);
    return usual ? std::optional(nanoseconds * role_factor(Role::time, *usual).value_or(1.0)) : std::nullopt;
}

ColumnScale parse_scale(std::string_view text, std::string_view label) {
    ColumnScale scale;
    scale.text = text;
    const auto complain = [&](std::string_view why) {
        raise<UsageError>(
            "{}: '{}': {}; write FACTOR and UNIT, then /DIVISOR, then +OFFSET, as in 0.04Nm, 360deg/524288 "
            "or 2Nm+10Nm",
            label, text, why);
    };
    // The longest beginning that is a number; what follows it is left.
    const auto take_number = [](std::string_view& rest) -> std::optional<double> {
        for (std::size_t size = std::min(rest.find_first_not_of("0123456789.eE+-"), rest.size()); size > 0;
             --size) {
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
           !(rest[end] == '/' && end + 1 < rest.size() && is_digit(rest[end + 1])))
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
    const std::string_view text = without_padding(written);
    // "% of rated", "0.1 %".
    if (text.find('%') != std::string_view::npos || text.find("\xe2\x80\xb0") != std::string_view::npos)
        return text.size() < 20;
    std::string unit = text.size() < 3 ? std::string(text) : without_signs(lower_case(text), " ");
    for (const std::string_view rate : {"/s", "_s", "/sec", "_per_s"})
        if (unit.ends_with(rate)) unit.resize(unit.size() - rate.size());
    return spelled(Dimension::none, unit).has_value();
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
    const bool rounded = std::ranges::any_of(steps, [&](double step) { return steps.count(step + 1.0) > 0; });
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
        layout.warn("derived velocity",
                    fmt::format("no velocity is logged: it is the slope of {}, from row to row; --columns "
                                "velocity=NAME decides otherwise",
                                label),
                    true);
        layout.infer("velocity", fmt::format("the slope of {}", label), "no column is a velocity",
                     "--columns velocity=NAME");
    }
}

}  // namespace ripplenotch
