// SPDX-License-Identifier: MIT
#pragma once
// Internal: what happened to a joint, by the pattern in which its descriptors changed.

#include <string>
#include <vector>

#include "fleet/trend/change_test.hpp"

namespace ripplenotch {

/// The change of every series at one position, with the errors and their correlation.
struct ChangedSeries {
    std::size_t series = 0;
    Extra extra;
    double baseline = 0.0;
};

/// Changes of the series in which it is identifiable. `scatter`: prior on each in addition to its lines.
[[nodiscard]] std::vector<ChangedSeries> changed_series(const JointHistory& history,
                                                        const std::vector<Regression>& known,
                                                        const ScatterOfSeries& scatter,
                                                        const FoundChange& change);

/// The cause that explains the changes with the fewest numbers (by Schwarz's criterion); where none does, a
/// list of the descriptors that took part.
[[nodiscard]] std::string cause_of(const JointHistory& history, const std::vector<Regression>& known,
                                   const FoundChange& change, const std::vector<ChangedSeries>& changed);

}  // namespace ripplenotch
