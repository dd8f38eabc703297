// SPDX-License-Identifier: MIT
#pragma once
// The delay ledger: the delays of a method, band by band, measured on the output of the running filter.

#include <optional>
#include <string>
#include <vector>

#include "ripplenotch/core/quantity.hpp"
#include "ripplenotch/evaluate/contender.hpp"

namespace ripplenotch {

/// One filter that can come into force: that of a band, or of a method without bands at one speed.
struct LedgerEntry {
    int band = 0;  ///< 0 when the method has no bands
    /// Range of the band, or twice the speed of a filter that follows it; both 0 for one that does neither.
    DegPerSec from, to;
    std::string filter;                   ///< description of the filter
    Seconds dc_delay;                     ///< group delay at 0 Hz at the log's rate
    std::optional<Seconds> ramp_delay;    ///< how far its output lags on a ramp; empty when not measured
    std::optional<StepMeasurement> step;  ///< empty when not measured
    std::optional<double> phase_lag_deg;  ///< at LedgerRequest::crossover; a lead is negative
    std::optional<double> crossover_db;   ///< gain there
};

struct LedgerRequest {
    std::optional<Hertz> crossover;  ///< crossover of the control loop that the torque is for
    bool measured = true;            ///< run a step and a ramp; else only what follows from the sections
};

/// Phase lag, summed over the sections so that it does not wrap, in degrees, and gain in dB at one frequency.
struct CrossoverFigures {
    double phase_lag_deg = 0.0, gain_db = 0.0;
};
/// Throws UsageError unless 0 < at < sampled.rate / 2.
[[nodiscard]] CrossoverFigures at_crossover(std::span<const Biquad> cascade, Hertz at, SampledAt sampled);

/// One entry for every band of a method's table, at its middle speed; for a method that follows the gear at
/// 5, 10, 20, 50, 100 and 200 deg/s; else one entry.
[[nodiscard]] std::vector<LedgerEntry> delay_ledger(const Contender& contender, Hertz sample_rate,
                                                    const LedgerRequest& request);

/// The longest DC delay of a method, and at which speed, for |v| in `speeds`; a joint slower than a hundredth
/// of the fastest counts as standstill.
struct LongestDelay {
    Seconds delay;
    DegPerSec speed;
    std::string filter;
};
[[nodiscard]] LongestDelay longest_delay(const Contender& contender, Hertz sample_rate,
                                         const SpeedSpan& speeds);

/// The lowest speed above which a method's DC delay stays within `limit`, to 1 %; 0 when it always is, empty
/// when it is not at any speed up to where its lowest order reaches half the sample rate.
[[nodiscard]] std::optional<DegPerSec> within_from(const Contender& contender, Hertz sample_rate,
                                                   Seconds limit);

}  // namespace ripplenotch
