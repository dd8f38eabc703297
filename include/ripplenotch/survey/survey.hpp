// SPDX-License-Identifier: MIT
#pragma once
// Looks through a log: its columns, its clock, its joints with their steady stretches, and what all this is
// good for.

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "ripplenotch/core/driven_torque.hpp"
#include "ripplenotch/log/layout.hpp"
#include "ripplenotch/log/log.hpp"
#include "ripplenotch/log/recording.hpp"

namespace ripplenotch {

/// Lowest and highest value of a signal.
struct Range {
    double min = 0.0, max = 0.0;
};

/// A stretch of the log in which one joint keeps its speed.
struct SteadyStretch {
    double from_s = 0.0, duration_s = 0.0, speed_deg_s = 0.0;
    bool rest = false;
};

/// One joint's figures. A signal that the log lacks has no range.
struct JointInfo {
    std::string joint;
    std::optional<Range> speed_deg_s, torque_nm, position_deg;
    Recording recording;
    std::optional<double> clock_factor;
    double turns = 0.0;                    ///< turns of the joint, both directions added up
    std::vector<SteadyStretch> stretches;  ///< standstill included
    std::string second_log;                ///< what it must have: second_log(); empty: this one does not move
    std::optional<DrivenTorque> drive;     ///< where its torque is that of a control law; not found by survey
    std::string options;                   ///< the option line that reads this joint
};

/// One thing to do with the log: whether it can, and why or why not.
struct Use {
    std::string name;  ///< "spectrum", "identify", "filter", "clock-check", "diagnose"
    bool possible = false;
    std::string reason;  ///< one sentence
};

struct LogInfo {
    std::string source;
    Layout layout;  ///< layout of the file, or of the joint chosen
    std::size_t rows = 0;
    std::optional<double> duration_s;  ///< first to last time, gaps included; empty without a clock
    ClockFacts clock;
    std::size_t bad_values_held = 0;
    std::vector<JointInfo> joints;
    std::vector<Use> uses;
    std::vector<std::string> warnings;
};

/// Reads the log, each joint of it unless one is chosen. Throws what reading throws; a log without torque,
/// velocity or time is described all the same. One of more than `most_rows` goes by twice and is not held:
/// its stretches are then those of means of as many rows as it takes. `makes_torque`: a control law makes the
/// torque, so that no column of it is missed by what needs no other.
[[nodiscard]] LogInfo survey_log(const std::string& path, ReadOptions options,
                                 std::size_t most_rows = most_rows_held, bool makes_torque = false);

}  // namespace ripplenotch
