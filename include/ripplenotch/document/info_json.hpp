// SPDX-License-Identifier: MIT
#pragma once
// What info says about a log: its columns, its clock, its joints, and what it is good for.

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "ripplenotch/document/provenance.hpp"
#include "ripplenotch/log/layout.hpp"
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
    double turns = 0.0;                    ///< of the joint, both directions added up
    std::vector<SteadyStretch> stretches;  ///< rest included
    std::string options;                   ///< the option line that reads this joint
};

/// One thing to do with the log: whether it can, and why or why not.
struct Use {
    std::string name;  ///< "spectrum", "identify", "filter", "clock-check"
    bool possible = false;
    std::string reason;  ///< one sentence
};

struct LogInfo {
    std::string source;
    Layout layout;  ///< of the file, or of the joint chosen
    std::size_t rows = 0;
    std::optional<double> duration_s;  ///< first to last time, gaps included; empty without a clock
    ClockFacts clock;
    std::size_t bad_values_held = 0;
    std::vector<JointInfo> joints;
    std::vector<Use> uses;
    std::vector<std::string> warnings;
};

/// The object of info --json: the fields of design.md section 3 at the top for one log, or {"logs": [...]}
/// with the same fields each for several. Of several joints, `held_samples` is the largest, `clock_factor`
/// that of the joint that moves most, `speed_deg_s` spans all; each joint's own figures are in `joints`.
[[nodiscard]] std::string info_to_json(std::span<const LogInfo> logs, const Provenance& provenance);

}  // namespace ripplenotch
