// SPDX-License-Identifier: MIT
#pragma once
// What a reader decided about a log: which column is what, in which unit, and how the file is written.

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "ripplenotch/core/units.hpp"

namespace ripplenotch {

enum class Role { time, velocity, torque, position, other };
[[nodiscard]] std::string_view role_name(Role role);

/// One column of the file, in file order.
struct Column {
    std::string name;  ///< as in the header, without quotes; "column 3" when there is no header
    Role role = Role::other;
    std::string unit;           ///< as understood ("rad/s"); empty for role other
    double factor = 1.0;        ///< file value * factor = value in the tool's unit
    bool unit_assumed = false;  ///< nothing in the log named the unit
    std::string joint;          ///< "" when the file holds one unnamed joint
};

/// What the caller asks of a reader; everything left out is found out from the file.
struct ReadOptions {
    std::optional<std::string> format;         ///< name in the format registry: "csv", "npy"
    std::optional<std::string> joint;          ///< one joint's name
    bool every_joint = false;                  ///< read all joints that have a velocity and a torque, at once
    std::vector<std::string> columns;          ///< "time,velocity,torque" by place, or "torque=tau_J" by name
    std::map<std::string, std::string> units;  ///< role or column name -> unit
    std::optional<Hertz> sample_rate;          ///< for logs without time; overrides the log's own time
    std::optional<char> delimiter;
    std::optional<char> decimal_mark;
    std::optional<bool> header;
    std::optional<double> nm_per_ampere;  ///< torque constant for current columns (--kt)
    bool hold_bad_values = false;         ///< replace nan and empty cells by the sample before, and count
    bool needs_torque = true;             ///< false for info
};

/// The columns of the joint chosen, by index into Layout::columns.
struct JointColumns {
    std::string joint;
    std::optional<std::size_t> time, velocity, torque, position;
};

struct Layout {
    std::string source;  ///< for messages: path or "standard input"
    std::string format;  ///< "csv", "npy"
    std::vector<Column> columns;
    std::vector<std::string> joints;    ///< all joints in the file, in file order
    JointColumns chosen;                ///< the joint that is read; the first of them
    std::vector<JointColumns> others;   ///< that are read with it, when every joint is
    std::optional<Hertz> stated_rate;   ///< from --sample-rate
    std::string options;                ///< the option line that would force this reading
    std::vector<std::string> warnings;  ///< one sentence each

    /// All joints that are read.
    [[nodiscard]] std::vector<JointColumns> all_chosen() const {
        std::vector<JointColumns> all = {chosen};
        all.insert(all.end(), others.begin(), others.end());
        return all;
    }
};

}  // namespace ripplenotch
