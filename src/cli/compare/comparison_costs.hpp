// SPDX-License-Identifier: MIT
#pragma once
// What the methods of a comparison cost a control loop, and whether that is within the user's limits.

#include <optional>
#include <string>
#include <vector>

#include "cli/compare/contenders.hpp"
#include "cli/options/gates.hpp"
#include "cli/options/options.hpp"
#include "ripplenotch/evaluate/comparison.hpp"

namespace ripplenotch {

struct CostRequest {
    std::optional<Hertz> crossover;
    Gates gates;
    bool ledger = false;
};
void attach_costs(Options& options, CostRequest& request);

/// Phase lag and gain at the crossover, the ledger, and from which speed on a delay limit is kept, as asked.
void add_costs(Comparison& comparison, const CostRequest& request, const Field& field);

/// One sentence for each limit that a method other than the control breaks.
[[nodiscard]] std::vector<std::string> violations(const Comparison& comparison, const CostRequest& request,
                                                  const Field& field);

}  // namespace ripplenotch
