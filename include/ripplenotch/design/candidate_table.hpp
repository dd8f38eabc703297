// SPDX-License-Identifier: MIT
#pragma once
// The table of candidate notch filters, one row per band of joint speed (Kim, Kim, Song 2011, table 1).

#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "ripplenotch/core/biquad.hpp"
#include "ripplenotch/core/speed_span.hpp"
#include "ripplenotch/core/units.hpp"
#include "ripplenotch/design/notch.hpp"

namespace ripplenotch {

struct CandidateNotch {
    Order order;
    NotchSpec notch;
    Biquad section;
};

/// One band: from < |v| <= to, as in the paper.
struct Band {
    int number = 0;  ///< from 1
    DegPerSec from, to;
    std::vector<CandidateNotch> notches;  ///< one per order, lowest first
    Seconds dc_delay;                     ///< group delay at 0 Hz of all notches in series
    Seconds settle;                       ///< of a step, into settle_band_percent
    double settle_band_percent = 0.5;
    double overshoot_percent = 0.0;
    std::vector<double> worst_attenuation_db;  ///< per order, anywhere in the band
    double held_attenuation_db = 0.0;          ///< of all orders, weighed by TableSpec::amplitude_nm; without
                                               ///< amplitudes, of the order least attenuated
    std::vector<double>
        predicted_residual_nm;  ///< per order, the most that is left; empty without amplitudes

    [[nodiscard]] Cascade cascade() const;
};

/// What happens where no band applies: the torque passes, the nearest band's filter stays, or a blend of both
/// (see docs/methods/switching.md).
enum class OutsideRule { pass, hold, fade };
[[nodiscard]] std::string_view outside_rule_name(OutsideRule rule);

struct TableSpec {
    GearRatio gear_ratio;
    std::vector<Order> orders;
    Hertz sample_rate;
    std::vector<std::pair<DegPerSec, DegPerSec>> bands;  ///< from, to; sorted, not overlapping
    double q = 0.25;                                     ///< the paper's twin-T
    double depth_db = infinite_depth_db;
    WidthRule width = WidthRule::analog;
    double ratio_error = 0.0;            ///< share by which the true gear ratio may be off, 0 <= it < 0.5
    std::vector<double> amplitude_nm{};  ///< of the ripple, zero to peak, one per order; empty when unknown
    double settle_band_percent = 0.5;    ///< the one that fits the paper's figures (docs/theory.md)
    OutsideRule below = OutsideRule::pass;
    OutsideRule above = OutsideRule::hold;
};

/// Bands of equal width, e.g. 18:180:18. Throws UsageError on an empty, backward, non-finite or uneven range.
[[nodiscard]] std::vector<std::pair<DegPerSec, DegPerSec>> bands_by_spacing(const SpeedSpan& speeds,
                                                                            DegPerSec spacing);

/// Throws UsageError unless everything in `spec` but its bands and notches makes sense.
void check_ripple(const TableSpec& spec);

/// Fills in what follows from a band's edges and notches: dc_delay, settle, overshoot_percent, and how far
/// the whole cascade attenuates the line of each order, over speeds from..to and gear ratios within
/// ratio_error.
void measure_band(Band& band, const TableSpec& spec);

/// Sorted, non-overlapping bands with their filters; an object of this type is always valid.
class CandidateTable {
  public:
    /// Designs every band, notch centres at the band's middle speed. Throws UsageError that names the band
    /// and the limit: centre not below half the sample rate, Q, depth, bands that overlap or run backward, no
    /// orders.
    static CandidateTable design(const TableSpec& spec);
    /// From stored rows (table.json): checks the same limits and that each section is stable.
    static CandidateTable from_bands(TableSpec spec, std::vector<Band> bands);

    [[nodiscard]] const TableSpec& spec() const { return spec_; }
    [[nodiscard]] std::span<const Band> bands() const { return bands_; }
    /// Index of the band with from < |v| <= to; -1 below the first band or in a hole between bands, -2 above
    /// the last.
    [[nodiscard]] int find(DegPerSec speed) const noexcept;

  private:
    TableSpec spec_;
    std::vector<Band> bands_;
};

}  // namespace ripplenotch
