// SPDX-License-Identifier: MIT
#pragma once
// spectrum.json: peaks, noise floor, window and resolution of the spectrum of a log.

#include <optional>
#include <string>
#include <vector>

#include "ripplenotch/analysis/line_search.hpp"
#include "ripplenotch/analysis/order_map.hpp"
#include "ripplenotch/analysis/spectrum.hpp"
#include "ripplenotch/analysis/stretches.hpp"
#include "ripplenotch/analysis/track_report.hpp"
#include "ripplenotch/core/gear_account.hpp"
#include "ripplenotch/document/provenance.hpp"

namespace ripplenotch {

// A spectrum over speed as JSON.

/// Schema ripplenotch/spectrum/1 with `domain` campbell or order-map. `axis_name` is what the axis counts:
/// frequency_hz, order or order_output.
[[nodiscard]] std::string speed_map_text(const std::string& joint, const SpeedMap& map,
                                         std::string_view axis_name, const std::optional<GearAccount>& gear,
                                         const Provenance& provenance);

// What track measured, as JSON.

/// Schema ripplenotch/track/1; the columns are arrays, null where a line was not measured.
[[nodiscard]] std::string track_text(const TrackReport& report, const Provenance& provenance);

/// A frequency spectrum and the motion behind it.
struct LogSpectrum {
    Stretch stretch;
    Spectrum spectrum;
};

/// An order spectrum and the lines found in it.
struct OrderSpectrum {
    Stack stack;
    MotionLines lines;
    std::string doubt;  ///< why these orders may be others: half a sentence; empty where nothing says so
};

[[nodiscard]] std::string spectrum_text(const std::string& joint, const LogSpectrum& spectrum,
                                        double false_alarm, const Provenance& provenance);
[[nodiscard]] std::string order_spectrum_text(const std::string& joint, const OrderSpectrum& spectrum,
                                              double false_alarm, const Provenance& provenance);

/// Median of a noise floor, bins without one left out.
[[nodiscard]] double median_floor(const std::vector<double>& floor_nm);

}  // namespace ripplenotch
