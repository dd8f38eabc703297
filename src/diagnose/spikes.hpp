// SPDX-License-Identifier: MIT
#pragma once
// Single samples that stand off their neighbours.

#include <cstddef>
#include <vector>

#include "diagnose/case.hpp"

namespace ripplenotch {

struct Spike {
    std::size_t sample = 0;
    double size_nm = 0.0;  ///< distance from what its neighbours let expect
};

/// None when they are fewer than three, or when they go on from the noise as heavy tails do. `least_nm`: the
/// log's own noise or step, in which nothing is a spike. Samples that do not count are no neighbours.
[[nodiscard]] std::vector<Spike> find_spikes(const Case& looked_at, double least_nm);

}  // namespace ripplenotch
