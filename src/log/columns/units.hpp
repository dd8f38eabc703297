// SPDX-License-Identifier: MIT
#pragma once
// Units as log headers spell them: "[rad/s]", "(deg/sec)", "_Nm", "1/min". The result is a name that
// core/quantity knows.

#include <algorithm>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "log/columns/decide_layout.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/quantity.hpp"
#include "ripplenotch/log/layout.hpp"

namespace ripplenotch {

/// Calls `take` for each word of a list with blanks between them, as names.def has them.
template <class Take>
void for_each_word(std::string_view list, const Take& take) {
    while (!list.empty()) {
        const std::size_t blank = std::min(list.find(' '), list.size());
        if (blank > 0) take(list.substr(0, blank));
        list.remove_prefix(std::min(list.size(), blank + 1));
    }
}

[[nodiscard]] inline bool has_word(std::string_view list, std::string_view word) {
    bool found = false;
    for_each_word(list, [&](std::string_view one) { found = found || one == word; });
    return found;
}

[[nodiscard]] inline bool is_digit(char c) { return c >= '0' && c <= '9'; }
/// One and more, and nothing else.
[[nodiscard]] inline bool is_digits(std::string_view text) {
    return !text.empty() && std::ranges::all_of(text, is_digit);
}

/// Without these characters at both ends.
[[nodiscard]] inline std::string_view trimmed(std::string_view text, std::string_view what) {
    text.remove_prefix(std::min(text.find_first_not_of(what), text.size()));
    return text.substr(0, text.find_last_not_of(what) + 1);
}

/// Throws what an option answers, a unit or a scale that the log does not state: exit code 5.
template <class... Args>
[[noreturn]] void ask(fmt::format_string<Args...> format, Args&&... args) {
    throw Error(ExitCode::inconclusive, fmt::format(format, std::forward<Args>(args)...));
}

/// The unit's usual name ("rad/s" for "rad s^-1"), or empty when no time, angle, speed, torque or current
/// unit is meant. With a role, spellings that depend on it are understood: "nm" is Nm in a torque, "s"
/// seconds in a time.
[[nodiscard]] std::optional<std::string> usual_unit(std::string_view written, Role role);

/// What a role measures: time, speed, torque (or current), angle.
[[nodiscard]] Dimension dimension_of(Role role);

/// What turns currents and linear units into those of a joint.
struct Conversion {
    double nm_per_ampere = 1.0;
    double lead_m = 1.0;  ///< travel of one turn of the screw
};

/// Factor from `unit` to the tool's unit for the role. A torque may be a current; a linear axis has positions
/// in m, speeds in m/s and forces in N, which become those of its screw: 360 deg and 2 pi N m / N a lead.
[[nodiscard]] std::optional<double> role_factor(Role role, std::string_view unit,
                                                const Conversion& conversion = {});

/// Whether a position, velocity or torque in `unit` is that of a linear axis.
[[nodiscard]] bool is_linear_unit(Role role, std::string_view unit);

/// True for A and mA.
[[nodiscard]] bool is_current_unit(std::string_view unit);

/// A column name taken apart: what it calls the quantity, and the unit it ends in, if any.
struct NameAndUnit {
    std::string name;        ///< "dq" of "dq [rad/s]"
    std::string unit;        ///< "rad/s", as written; empty when none is there
    bool bracketed = false;  ///< in brackets: surely meant as a unit
};
/// A unit of what the name measures, where that is known. "_m", "_mm" and "_N" are units in names of a linear
/// axis alone: elsewhere an m is the motor's.
[[nodiscard]] NameAndUnit split_unit(std::string_view column_name, Role role = Role::other,
                                     bool linear_axis = false);

/// Nanoseconds in one unit of a clock: as `unit` states it, else as its name ends in it; none where neither
/// does.
[[nodiscard]] std::optional<double> stated_clock_ns(const std::string& unit, std::string_view name);

// A part of decide_layout: units that --unit states, and what is said of units that nobody stated.

/// What --unit (ReadOptions::units) or --scale (ReadOptions::scales) says of a column, by its name or by its
/// role; null where it says nothing.
template <class Stated>
[[nodiscard]] const Stated* stated_of(const std::map<std::string, Stated>& stated, const std::string& name,
                                      Role role) {
    auto found = stated.find(name);
    if (found == stated.end()) found = stated.find(std::string(role_name(role)));
    return found == stated.end() ? nullptr : &found->second;
}

/// Counts, per mille and other numbers of a device, which are a quantity only with a scale.
[[nodiscard]] bool is_device_unit(std::string_view written);
/// Many different whole numbers and none with decimals: a physical quantity has decimals. Steps that differ
/// by one come from rounding; a made-up ramp has none. Not-a-numbers are left out.
[[nodiscard]] bool counts_only(const std::vector<double>& values);
/// How one of them is stated: "--scale position=360deg/524288".
[[nodiscard]] std::string scale_example(Role role, std::string_view device_unit = {});

/// Units that a column of this role may have, as messages list them.
[[nodiscard]] std::string unit_list(Role role);

/// Adds warnings: units that were assumed, currents without a torque constant, a torque constant without
/// currents. Throws UsageError for a --unit or --scale that names neither a role nor a column.
void state_units(Layout& layout, const ColumnFacts& facts, const ReadOptions& options);

/// Marks a layout whose joints lack a velocity that their position can give, with a warning.
void state_derived_velocity(Layout& layout, const ColumnFacts& facts);

}  // namespace ripplenotch
