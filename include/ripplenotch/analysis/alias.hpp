// SPDX-License-Identifier: MIT
#pragma once
// Folded orders: what turns faster than half the sample rate is seen at |k * rate - order * |v| / 360|. The
// sum over the measured angle may be asked at the unfolded order directly: where the speed changes within a
// sweep, the true order gathers more of the line than its images do.

#include <optional>
#include <span>
#include <vector>

#include "ripplenotch/analysis/stack.hpp"
#include "ripplenotch/core/units.hpp"

namespace ripplenotch {

/// One order that a seen line could be in truth.
struct Fold {
    double order_output = 0.0;
    double gain = 0.0;  ///< what it explains of the samples, in nats, comparable with the seen order's own
};

/// A frequency and the rate at which it is sampled.
struct SampledLine {
    double hz = 0.0, rate_hz = 0.0;
};
/// Frequency at which a line is seen: 0 to half the rate.
[[nodiscard]] double folded_hz(const SampledLine& line);

/// An order as it is seen, and the highest that it may be in truth; both per output turn.
struct SeenOrder {
    double seen = 0.0, highest = 0.0;
};
/// Orders up to the highest whose image at this speed is the one seen, lowest first.
[[nodiscard]] std::vector<double> unfolded_orders(const SeenOrder& order, Hertz rate, DegPerSec speed);

/// The same with what each explains, best first. Each is asked at its own maximum, within what the speeds of
/// the heaviest sweep allow. Rests on the heaviest sweeps, 20,000 samples at most. Empty where no image lies
/// below the highest order.
[[nodiscard]] std::vector<Fold> folds_of(std::span<const Sweep> sweeps, const Stack& angle,
                                         const SeenOrder& order);

/// What is known of a line that may be folded.
struct FoldQuestion {
    double seen = 0.0;                        ///< output order
    double tolerance = 0.0;                   ///< of an order, to lie on the hint's comb, besides 0.6 % of it
    double gain_seen = 0.0, gain_time = 0.0;  ///< of the seen order, and of a fixed tone
    std::span<const Fold> folds;
};

struct FoldAnswer {
    std::optional<double> order_output;  ///< the order that is folded; empty when it may not be
    bool by_hint = false;
    std::vector<double> could_be;  ///< orders that explain the line about as well, lowest first
};

/// A fold is the answer when it explains the samples decisively better than anything else, or when it does so
/// about as well and lies on the comb of the hinted ratio while the seen order does not.
[[nodiscard]] FoldAnswer answer_fold(const FoldQuestion& question, std::optional<GearRatio> hint);

}  // namespace ripplenotch
