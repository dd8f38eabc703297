// SPDX-License-Identifier: MIT
#pragma once
// The speed-switched bank as exported code runs it: one cascade whose memory stays while the coefficients
// change, a region of speed for every rule, and a test vector that goes through all of them.

#include <vector>

#include "ripplenotch/export/filter_set.hpp"
#include "ripplenotch/export/target.hpp"

namespace ripplenotch {

inline constexpr int region_passes = -1;  ///< no filter: the torque passes
inline constexpr int region_holds = -2;   ///< the filter in force stays

/// In force while |v| <= to and above the region before. With full and none apart, the share of the filtered
/// signal in the output falls linearly from 1 at `full` to 0 at `none`.
struct BankRegion {
    double to_deg_s = 0.0;  ///< infinite in the last
    int band = region_passes;
    double full_deg_s = 0.0, none_deg_s = 0.0;
};

/// The same regions as the method `switching` runs (docs/methods/switching.md), slowest first.
[[nodiscard]] std::vector<BankRegion> bank_regions(const FilterSet& filters);

struct GoldenVector {
    std::vector<double> torque_nm, speed_deg_s, expected_nm;
};

/// Torque and speed that float holds exactly, going through the regions up and down, and what the bank puts
/// out in its own arithmetic.
[[nodiscard]] GoldenVector golden_vector(const std::vector<BankRegion>& regions, const LoadedFilters& filters,
                                         Arithmetic arithmetic);

}  // namespace ripplenotch
