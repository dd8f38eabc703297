// SPDX-License-Identifier: MIT
#pragma once
// Stretches of a log in which the joint keeps its speed: where the paper's method, a DFT per speed, may be
// used.

#include <cstddef>
#include <span>
#include <vector>

#include "ripplenotch/core/trace.hpp"
#include "ripplenotch/core/units.hpp"

namespace ripplenotch {

struct SteadyRule {
    double band_percent = 5.0;  ///< speed stays within this share of its middle value to both sides ...
    double band_deg_s = 1.0;    ///< ... or within this, whichever is wider
    Seconds at_least{1.0};
    Seconds smoothing{
        0.1};  ///< velocity is averaged over this time before it is judged, against sensor noise
    double gap_steps = 10.0;  ///< a step in time of more than this many mean steps ends a stretch
};

struct Stretch {
    std::size_t first = 0, count = 0;
    Seconds duration;
    DegPerSec speed;  ///< signed mean: change of position over time where there is one, else mean velocity
    double speed_error_deg_s = 0.0;  ///< standard error of that mean
    bool rest = false;               ///< mean speed within half of band_deg_s of standstill
};

/// The longest stretch, then the longest beside it, and so on; not overlapping, in time order. O(n log n).
[[nodiscard]] std::vector<Stretch> steady_stretches(const TraceView& trace, const SteadyRule& rule);

/// One stretch made of all samples, whatever the speed does.
[[nodiscard]] Stretch whole_log(const TraceView& trace);

/// True when one steady stretch covers at least nine tenths of the log.
[[nodiscard]] bool whole_log_is_steady(const TraceView& trace, const std::vector<Stretch>& stretches);

/// Mean of `values` over `width` samples around each (odd width; shorter at the ends). O(n).
[[nodiscard]] std::vector<double> moving_mean(std::span<const double> values, std::size_t width);

}  // namespace ripplenotch
