// SPDX-License-Identifier: MIT
#include "log/columns/channel_clocks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "ripplenotch/core/error.hpp"

namespace ripplenotch::layout_detail {
namespace {

// The first row of which two clocks are more than half a step apart, if there is one.
std::optional<std::size_t> first_apart(const std::vector<double>& clock, const std::vector<double>& other) {
    const std::size_t rows = std::min(clock.size(), other.size());
    if (rows < 2) return std::nullopt;
    const double half_step = 0.5 * std::abs(clock[1] - clock[0]);
    for (std::size_t row = 0; row < rows; ++row)
        if (std::abs(other[row] - clock[row]) > half_step) return row;  // an empty cell is not apart
    return std::nullopt;
}

}  // namespace

void check_channel_clocks(const std::string& source, const ColumnFacts& facts, const Layout& layout) {
    if (facts.clock_of.empty() || !layout.chosen.time) return;
    const std::size_t time = *layout.chosen.time;
    for (const JointColumns& joint : layout.all_chosen()) {
        for (const auto& column : {joint.velocity, joint.torque, joint.position}) {
            if (!column) continue;
            const std::size_t own = facts.clock_of[*column];
            if (own == time) continue;
            const auto row = first_apart(facts.sample[time], facts.sample[own]);
            if (!row) continue;
            raise<DataError>(
                "{}: read {} at times of its own: {} in row {} (column {}), where column {} has {}; expected "
                "one "
                "clock; export all channels at one rate from one start, or name channels of one clock with "
                "--columns time=NUMBER,...",
                source, column_label(facts.names, *column), facts.sample[own][*row], *row + 1, own + 1,
                time + 1, facts.sample[time][*row]);
        }
    }
}

}  // namespace ripplenotch::layout_detail
