// SPDX-License-Identifier: MIT
#pragma once
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "cli/options/options.hpp"
#include "ripplenotch/document/provenance.hpp"
#include "ripplenotch/evaluate/comparison.hpp"

namespace ripplenotch {

// The methods of a comparison and the ripple it looks at, from what was typed and the files it names.

struct Field {
    std::vector<Contender> contenders;            ///< the control first, unless it was typed elsewhere
    std::shared_ptr<const CandidateTable> table;  ///< of the first method that needs one
    /// Whose ripple all of them are measured by: that of the options and the joint file, else of the first
    /// method that follows the gear, else of the first table. Empty when nothing says where the ripple is.
    std::optional<GearAccount> gear;
};

// What the methods of a comparison cost a control loop, and whether that is within the user's limits.

struct CostRequest {
    std::optional<Hertz> crossover;
    Gates gates;
    bool ledger = false;
};

/// One sentence for each limit that a method other than the control breaks.
[[nodiscard]] std::vector<std::string> violations(const Comparison& comparison, const CostRequest& request,
                                                  const Field& field);

}  // namespace ripplenotch
