// SPDX-License-Identifier: MIT
#pragma once
// One joint's log in memory, in the units of the tool.

#include <span>
#include <string>
#include <vector>

#include "ripplenotch/core/units.hpp"

namespace ripplenotch {

/// A view of n samples of one joint. Spans have n entries each; `position_deg` is empty when the log has
/// none. Time is increasing; it need not be uniform, `sample_rate` is the measured mean rate (samples per
/// second without gaps).
struct TraceView {
    Hertz sample_rate;
    std::span<const double> time_s;
    std::span<const double> velocity_deg_s;
    std::span<const double> torque_nm;
    std::span<const double> position_deg;

    [[nodiscard]] std::size_t size() const { return torque_nm.size(); }
    [[nodiscard]] bool has_position() const { return !position_deg.empty(); }
    [[nodiscard]] TraceView part(std::size_t first, std::size_t count) const {
        return {sample_rate, time_s.subspan(first, count), velocity_deg_s.subspan(first, count),
                torque_nm.subspan(first, count),
                has_position() ? position_deg.subspan(first, count) : std::span<const double>{}};
    }
};

/// Owns what TraceView borrows. `joint` is empty for a log of one unnamed joint.
struct Trace {
    std::string source;
    std::string joint;
    Hertz sample_rate;
    std::vector<double> time_s, velocity_deg_s, torque_nm, position_deg;

    [[nodiscard]] std::size_t size() const { return torque_nm.size(); }
    [[nodiscard]] TraceView view() const {
        return {sample_rate, time_s, velocity_deg_s, torque_nm, position_deg};
    }
};

}  // namespace ripplenotch
