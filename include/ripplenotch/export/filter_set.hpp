// SPDX-License-Identifier: MIT
#pragma once
// What an export starts from: sections with what they were designed for, band by band, whether they come from
// a candidate table or from one filter that runs at every speed.

#include <optional>
#include <span>
#include <vector>

#include "ripplenotch/core/biquad.hpp"
#include "ripplenotch/core/units.hpp"
#include "ripplenotch/design/candidate_table.hpp"
#include "ripplenotch/design/low_pass.hpp"
#include "ripplenotch/design/notch.hpp"

namespace ripplenotch {

struct ExportSection {
    std::optional<Order> order;      ///< the line that a table's notch stands for
    std::optional<NotchSpec> notch;  ///< empty for a section of a low-pass
    Hertz center;                    ///< the notch's centre, else the natural frequency of the poles
    Biquad section;
};

struct ExportBand {
    int number = 0;      ///< from 1; 0 for a filter without bands
    DegPerSec from, to;  ///< in force while from < |v| <= to; both 0 without bands
    std::vector<ExportSection> sections;

    [[nodiscard]] DegPerSec middle() const { return 0.5 * (from + to); }
};

/// At least one band of at least one section; all bands have the same number of sections; every section has
/// gain 1 at 0 Hz and is stable.
struct FilterSet {
    Hertz sample_rate;
    std::optional<GearRatio> gear_ratio;  ///< there exactly when the bands are chosen by joint speed
    std::vector<ExportBand> bands;
    OutsideRule below = OutsideRule::pass, above = OutsideRule::hold;

    [[nodiscard]] bool by_speed() const { return gear_ratio.has_value(); }
    [[nodiscard]] std::size_t sections_per_band() const { return bands.front().sections.size(); }
};

[[nodiscard]] FilterSet filter_set(const CandidateTable& table);
/// One band of a table, to run at every speed. Throws UsageError when there is no band of that number.
[[nodiscard]] FilterSet only_band(const FilterSet& table, int number);
/// One filter for all speeds. Throws what design_notch throws, UsageError when there is no notch.
[[nodiscard]] FilterSet filter_set(std::span<const NotchSpec> notches, Hertz sample_rate);
/// Throws what design_low_pass throws.
[[nodiscard]] FilterSet filter_set(const LowPassSpec& low_pass, Hertz sample_rate);

}  // namespace ripplenotch
