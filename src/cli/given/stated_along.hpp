// SPDX-License-Identifier: MIT
#pragma once
// What is given of a log's torque where nothing is left to be fitted: for commands that predict a torque.

#include "cli/given/given_terms.hpp"

namespace ripplenotch {

/// The sum of what the model and the options state; rows of the log that it does not span are taken out.
/// Nothing given: empty. Throws UsageError for a value that is still to be fitted, and what GivenSource
/// throws.
[[nodiscard]] std::vector<double> stated_torque_along(const GivenOptions& options,
                                                      const ModelWithGiven& model, const ReadOptions& reading,
                                                      const GivenLog& log);

/// The scale that leaves least of the log's torque beside an offset, where it is not stated. What is in the
/// torque besides may move it a little.
void settle_simulation(std::vector<GivenTerm>& terms, const Trace& log);

}  // namespace ripplenotch
