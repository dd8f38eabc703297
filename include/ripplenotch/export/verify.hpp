// SPDX-License-Identifier: MIT
#pragma once
// Verification of an export: every section that was read back, run in the target's arithmetic and measured
// against its design.

#include <optional>
#include <string>
#include <vector>

#include "ripplenotch/export/target.hpp"

namespace ripplenotch {

/// A deeper notch than this is given as this: below it one would measure the test signal's own rounding.
inline constexpr double deepest_measured_db = 120.0;

/// The torque on which a section is run: a steady load with 1 Nm of ripple at the designed centre.
inline constexpr double verify_load_nm = 8.0;

struct SectionCheck {
    int band = 0;  ///< number, 0 without bands
    DegPerSec from, to;
    int section = 1;  ///< from 1
    std::optional<Order> order;
    GearRatio gear_ratio;                 ///< under which it counts
    Hertz center;                         ///< as designed
    bool is_notch = true;                 ///< false: a section of a low-pass, which has no depth
    std::optional<double> shift_percent;  ///< shift of the centre, from the values read; empty: it has none
    double designed_gain = 0.0;           ///< at the centre of a notch
    double q = 0.0;                       ///< Q of the poles read
    double response_depth_db = 0.0;       ///< at the designed centre, from the coefficients read
    std::optional<double> depth_db;       ///< the same, from running it; empty when it cannot be run
    std::optional<double> dc_error_db;    ///< error of the gain at 0 Hz, from running it
    std::optional<double> mean_error_nm;  ///< on the load of 8 Nm, from running it
    double pole_radius = 0.0;             ///< below 1 is stable
};

/// Centre (where the zeros are, or the poles of a low-pass), Q, depth and largest pole radius of a transfer
/// function; everything but what takes running.
[[nodiscard]] SectionCheck check_response(const Biquad& section, const ExportSection& designed,
                                          Hertz sample_rate);

/// Throws DataError when bands or sections are not as many as in `filters`.
[[nodiscard]] std::vector<SectionCheck> verify_export(const FilterSet& filters, const LoadedFilters& loaded,
                                                      const std::string& source);

/// One sentence for each section that is not stable, and with a tolerance for each whose centre has moved by
/// more per cent of its frequency, or whose gain there or at 0 Hz is off by more per cent of the input.
[[nodiscard]] std::vector<std::string> export_violations(const std::vector<SectionCheck>& checks,
                                                         std::optional<double> tolerance_percent);

}  // namespace ripplenotch
