// SPDX-License-Identifier: MIT
#pragma once
// metrics.json: what a filter did to one log.

#include <optional>
#include <string>
#include <vector>

#include "ripplenotch/analysis/ripple_meter.hpp"
#include "ripplenotch/artifact/document.hpp"
#include "ripplenotch/core/units.hpp"
#include "ripplenotch/filter/engine.hpp"

namespace ripplenotch {

/// Delay of a filter that can come into force: of the only one, or of one band.
struct FilterDelay {
    int band = 0;        ///< 0 when the method has no bands
    DegPerSec from, to;  ///< of the band, or twice the speed of a filter that follows it; both 0 for one that
                         ///< does neither
    std::string filter;  ///< what it is, in words
    Seconds dc_delay;    ///< group delay at 0 Hz at the log's rate; a ramp comes late by this
};

struct FilterMetrics {
    std::string source, joint, method;  ///< the method as it would be typed again
    Hertz sample_rate;                  ///< that the filter was designed for, or started with
    std::optional<Hertz> table_rate;    ///< that the table was designed for
    StreamReport stream;
    std::optional<GearRatio> gear_ratio;  ///< empty when unknown: then there are no levels
    std::optional<RippleLevels> levels;   ///< of two signals, raw and filtered torque
    std::vector<FilterDelay> delays;
};

/// Attenuation of one order in dB; empty when there was nothing to attenuate or nothing was left.
[[nodiscard]] std::optional<double> attenuation_db(const OrderLevel& level);

/// The whole text of metrics.json, schema ripplenotch/metrics/1; same metrics, same bytes.
[[nodiscard]] std::string metrics_to_json(const FilterMetrics& metrics, const Provenance& provenance);

}  // namespace ripplenotch
