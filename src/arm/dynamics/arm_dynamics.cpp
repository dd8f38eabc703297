// SPDX-License-Identifier: MIT
#include "ripplenotch/arm/arm_dynamics.hpp"

#include "arm/dynamics/arm_states.hpp"
#include "ripplenotch/core/error.hpp"

namespace ripplenotch {
namespace {

// Calls `take(sample, row)` for every sample.
template <class Take>
void each_row(const Chain& chain, std::span<const Motion> motions, std::size_t joint, const Take& take) {
    if (joint >= chain.size()) raise<UsageError>("arm: joint {} of {}", joint + 1, chain.size());
    ArmStates states(chain, motions);
    ArmRow arm(chain);
    std::vector<double> row(values_of_a_link * chain.size());
    for (std::size_t k = 0; k < states.size(); ++k) {
        arm.move(states.at(k));
        arm.torque_of(joint, row);
        take(k, row);
    }
}

}  // namespace

std::vector<std::vector<double>> arm_columns(const Chain& chain, std::span<const Motion> motions,
                                             std::size_t joint) {
    std::vector<std::vector<double>> columns(values_of_a_link * chain.size());
    for (auto& column : columns) column.resize(motions.empty() ? 0 : motions.front().size());
    each_row(chain, motions, joint, [&](std::size_t k, const std::vector<double>& row) {
        for (std::size_t c = 0; c < row.size(); ++c) columns[c][k] = row[c];
    });
    return columns;
}

std::vector<double> arm_torque(const Chain& chain, std::span<const double> values,
                               std::span<const Motion> motions, std::size_t joint) {
    if (values.size() != values_of_a_link * chain.size())
        raise<UsageError>("arm: {} values for {} links", values.size(), chain.size());
    std::vector<double> torque_nm(motions.empty() ? 0 : motions.front().size());
    each_row(chain, motions, joint, [&](std::size_t k, const std::vector<double>& row) {
        double sum = 0.0;
        for (std::size_t c = 0; c < row.size(); ++c) sum += row[c] * values[c];
        torque_nm[k] = sum;
    });
    return torque_nm;
}

}  // namespace ripplenotch
