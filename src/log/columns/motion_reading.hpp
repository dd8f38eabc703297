// SPDX-License-Identifier: MIT
#pragma once
// Every way in which a joint's velocity and position could be written, and how much speaks against each.

#include <optional>
#include <string_view>
#include <vector>

#include "log/columns/infer_motion.hpp"
#include "log/columns/motion_evidence.hpp"

namespace ripplenotch::layout_detail {

/// One column's unit and side under a reading.
struct ReadColumn {
    std::string_view unit;
    double unit_factor = 1.0;  ///< to deg/s or deg
    Shaft side = Shaft::joint;
    double factor = 1.0;  ///< to the joint's deg/s or deg: by unit and ratio
};

struct MotionReading {
    ReadColumn velocity, position;
    std::optional<double> ratio;  ///< between the motor and the joint, where a side is the motor's
    bool against_header = false;  ///< a unit that the log states is wrong
    double cost = 0.0;            ///< the likeliest has the least
};

/// A reading is as possible as the likeliest when it costs less than this much more.
inline constexpr double open_margin = 1.0;

/// The columns that a motion has, with the factors of stated units in `layout`.
struct MotionQuestion {
    const MotionColumns& columns;
    const MotionEvidence& evidence;
    const Layout& layout;
    std::optional<double> gear_ratio;
};

/// All readings that fit the evidence, the likeliest first. `with_scale` false: position and velocity need
/// not belong together. Those against the header come last.
[[nodiscard]] std::vector<MotionReading> motion_readings(const MotionQuestion& question, bool with_scale);

}  // namespace ripplenotch::layout_detail
