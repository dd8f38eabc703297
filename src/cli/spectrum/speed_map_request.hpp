// SPDX-License-Identifier: MIT
#pragma once
// spectrum --map: its options, and the map as CSV or JSON.

#include <optional>
#include <string>

#include "cli/gear/gear_choice.hpp"
#include "cli/options/options.hpp"
#include "ripplenotch/analysis/order_map.hpp"
#include "ripplenotch/chart/spectrum_figure.hpp"
#include "ripplenotch/core/trace.hpp"
#include "ripplenotch/document/provenance.hpp"

namespace ripplenotch {

struct SpeedMapRequest {
    std::optional<std::string> map;  ///< "campbell" or "order"; nothing without it
    GearOptions gear;
    std::optional<double> resolution, highest;
    std::optional<DegPerSec> speed_step;
};

void attach_speed_map(Options& options, SpeedMapRequest& request);

/// Throws UsageError when options of the map are given without --map, or make no sense.
void check_speed_map(const SpeedMapRequest& request);

/// The lines that are drawn into the map, where a gear is known; notes the joint file as an input.
[[nodiscard]] MapLines map_lines(const SpeedMapRequest& request, Provenance& provenance);

/// CSV, one row a cell: speed_deg_s, then frequency_hz, order (with a gear ratio) or order_output, then
/// amplitude_nm. JSON: schema ripplenotch/spectrum/1.
struct SpeedMapResult {
    std::string text;
    SpeedMap map;
};
[[nodiscard]] SpeedMapResult speed_map_result(const SpeedMapRequest& request, const MapLines& lines,
                                              const Trace& trace, const CommonOptions& common,
                                              const Provenance& provenance);

}  // namespace ripplenotch
