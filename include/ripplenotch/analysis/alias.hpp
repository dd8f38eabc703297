// SPDX-License-Identifier: MIT
#pragma once
// Folded orders: a line above half the sample rate is seen at |k * rate - order * |v| / 360|. The sum over
// the measured angle may be evaluated at the unfolded order directly: where the speed changes within a sweep,
// the true order gathers more of the line than its images do.

#include <span>
#include <vector>

#include "ripplenotch/analysis/stack.hpp"
#include "ripplenotch/core/quantity.hpp"

namespace ripplenotch {

/// One order that a seen line could be in truth.
struct Fold {
    double order_output = 0.0;
    /// Improvement in log-likelihood (natural units), comparable with that of the order seen.
    double gain = 0.0;
};

/// An order as it is seen, and the highest that it may be in truth; both per output turn.
struct SeenOrder {
    double seen = 0.0, highest = 0.0;
};
/// Orders up to the highest whose image at the speeds of the sweeps is the one seen, with the improvement by
/// each, best first. Each is evaluated at its own maximum, within the speeds of the heaviest sweep. Uses the
/// heaviest sweeps, 20,000 samples at most. Empty where no image lies below the highest order.
[[nodiscard]] std::vector<Fold> folds_of(std::span<const Sweep> sweeps, const Stack& angle,
                                         const SeenOrder& order);

}  // namespace ripplenotch
