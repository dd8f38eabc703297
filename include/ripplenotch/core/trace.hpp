// SPDX-License-Identifier: MIT
#pragma once
// One joint's log in memory, in the units of the tool.

#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <vector>

#include "ripplenotch/core/quantity.hpp"

namespace ripplenotch {

// What a number from outside may be, so that no square, sum or product of such numbers overflows.

/// In any unit that the tool knows; the time of year 2026 in nanoseconds is 1.8e18.
constexpr double largest_reading = 1e30;

/// False for nan and infinities too.
[[nodiscard]] inline bool is_reading(double value) { return std::abs(value) <= largest_reading; }

/// A view of n samples of one joint. Spans have n entries each; `position_deg` is empty when the log has none
/// that is this joint's. Time is increasing; it need not be uniform, `sample_rate` is the measured mean rate
/// (samples per second without gaps). Who reads the log decides once which of its rows belong together and
/// whether the position is the joint's (log/account.hpp): nobody behind asks again.
struct TraceView {
    Hertz sample_rate;
    std::span<const double> time_s;
    std::span<const double> velocity_deg_s;
    std::span<const double> torque_nm;
    std::span<const double> position_deg;
    std::span<const std::size_t> run_starts = {};  ///< rows before which there is a gap in time; ascending
    std::size_t first_row = 0;                     ///< that row 0 here is, as run_starts counts

    [[nodiscard]] std::size_t size() const { return torque_nm.size(); }
    [[nodiscard]] bool has_position() const { return !position_deg.empty(); }
    /// Whether row k does not go on where the row before it ended.
    [[nodiscard]] bool starts_run(std::size_t k) const {
        return std::binary_search(run_starts.begin(), run_starts.end(), first_row + k);
    }
    [[nodiscard]] TraceView part(std::size_t first, std::size_t count) const {
        return {sample_rate,
                time_s.subspan(first, count),
                velocity_deg_s.subspan(first, count),
                torque_nm.subspan(first, count),
                has_position() ? position_deg.subspan(first, count) : std::span<const double>{},
                run_starts,
                first_row + first};
    }
};

/// Owns what TraceView borrows. `joint` is empty for a log of one unnamed joint.
struct Trace {
    std::string source;
    std::string joint;
    Hertz sample_rate;
    std::vector<double> time_s, velocity_deg_s, torque_nm, position_deg;
    std::vector<std::size_t> run_starts = {};  ///< as in TraceView

    [[nodiscard]] std::size_t size() const { return torque_nm.size(); }
    [[nodiscard]] TraceView view() const {
        return {sample_rate, time_s, velocity_deg_s, torque_nm, position_deg, run_starts};
    }
};

}  // namespace ripplenotch
