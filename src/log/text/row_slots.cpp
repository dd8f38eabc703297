// SPDX-License-Identifier: MIT
#include "log/text/row_slots.hpp"

namespace ripplenotch {

std::vector<WantedColumn> time_columns(const Layout& layout) {
    std::vector<WantedColumn> wanted;
    if (layout.chosen.time) wanted.push_back({*layout.chosen.time, time_slot});
    if (layout.time_fraction) wanted.push_back({*layout.time_fraction, time_slot, true});
    return wanted;
}

std::vector<WantedColumn> wanted_columns(const Layout& layout) {
    std::vector<WantedColumn> wanted = time_columns(layout);
    const auto want = [&wanted](std::optional<std::size_t> column, std::size_t slot) {
        if (column) wanted.push_back({*column, slot});
    };
    const std::vector<JointColumns> joints = layout.all_chosen();
    for (std::size_t j = 0; j < joints.size(); ++j) {
        want(joints[j].velocity, slot_of(velocity_slot, j));
        want(joints[j].torque, slot_of(torque_slot, j));
        want(joints[j].position, slot_of(position_slot, j));
    }
    return wanted;
}

StampRule stamp_rule(const Layout& layout, char decimal_mark) {
    const bool careful = layout.time_fraction || layout.time_as_text || layout.time_origin != 0;
    return {careful, layout.time_as_text, layout.time_origin, decimal_mark};
}

std::vector<double> slot_factors(const Layout& layout, const std::vector<WantedColumn>& wanted) {
    std::vector<double> factors(slot_count(1 + layout.others.size()), 1.0);
    for (const WantedColumn& one : wanted) {
        if (!one.fraction) factors[one.slot] = layout.columns[one.column].factor;
    }
    return factors;
}

}  // namespace ripplenotch
