// SPDX-License-Identifier: MIT
#pragma once
// Internal: is there a change in a joint, of any descriptor, anywhere in time? The largest statistic of all
// is held against what the same joint gives when its residuals are put in another order (Freedman and Lane,
// 1983), so that one p stands for all of them.

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "fleet/trend/joint_history.hpp"
#include "fleet/trend/kin_scatter.hpp"
#include "fleet/trend/regression.hpp"
#include "fleet/trend/scan.hpp"

namespace ripplenotch {

/// A change that was found: its column, and where it is.
struct FoundChange {
    bool drift = false;
    std::size_t row = 0;                   ///< of the joint's lines: the first after a step
    std::size_t earliest = 0, latest = 0;  ///< rows that are hardly worse
    double p = 1.0, limit = 0.0;
};

/// What a change adds to a row: 0 and 1 of a step, 0 to 1 of a drift.
[[nodiscard]] std::vector<double> change_column(const JointHistory& history, const FoundChange& change,
                                                std::span<const std::size_t> rows);

/// Each series beside the conditions and the changes that are known.
[[nodiscard]] std::vector<Regression> regressions(const JointHistory& history,
                                                  std::span<const FoundChange> known);

/// Every series that has enough lines, and all torques together.
[[nodiscard]] std::vector<Scan> scans_of(const JointHistory& history, const std::vector<Regression>& known);

/// The likeliest change, if its chance is at most `limit`; and the autocorrelation is kept by blocks.
/// `scatter`: what is known of each series beside its lines.
[[nodiscard]] std::optional<FoundChange> next_change(const JointHistory& history,
                                                     const std::vector<Regression>& known,
                                                     const ScatterOfSeries& scatter, double limit,
                                                     std::uint64_t seed);

}  // namespace ripplenotch
