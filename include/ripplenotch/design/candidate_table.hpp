// SPDX-License-Identifier: MIT
#pragma once
// The table of candidate notch filters, one row per band of joint speed (Kim, Kim, Song 2011, table 1).

#include <algorithm>
#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "ripplenotch/core/biquad.hpp"
#include "ripplenotch/core/quantity.hpp"
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
    Seconds settle;                       ///< settling time of a step, into settle_band_percent
    double settle_band_percent = 0.5;
    double overshoot_percent = 0.0;
    std::vector<double> worst_attenuation_db;  ///< per order, anywhere in the band
    /// Reduction of the ripple of all orders together, by TableSpec::amplitude_nm; without amplitudes the
    /// same as least_attenuation_db().
    double held_attenuation_db = 0.0;
    std::vector<double>
        predicted_residual_nm;  ///< per order, the most that is left; empty without amplitudes

    [[nodiscard]] Cascade cascade() const;
    /// The attenuation of the band: the least of any order anywhere in it.
    [[nodiscard]] double least_attenuation_db() const {
        return *std::min_element(worst_attenuation_db.begin(), worst_attenuation_db.end());
    }
};

/// What happens where no band applies: the torque passes, the nearest band's filter stays, or a blend of both
/// (see docs/methods/switching.md).
enum class OutsideRule { pass, hold, fade };
[[nodiscard]] std::string_view outside_rule_name(OutsideRule rule);

struct TableSpec {
    GearRatio gear_ratio;  ///< no_ratio (gear_account.hpp): the orders count by turns of the joint
    std::vector<Order> orders;
    Hertz sample_rate;
    std::vector<std::pair<DegPerSec, DegPerSec>> bands;  ///< from, to; sorted, not overlapping
    double q = 0.25;                                     ///< the paper's twin-T
    double depth_db = infinite_depth_db;
    WidthRule width = WidthRule::analog;
    double ratio_error = 0.0;  ///< share by which the true gear ratio may be off, 0 <= it < 0.5
    /// Ripple amplitudes, zero to peak, one per order; empty when unknown.
    std::vector<double> amplitude_nm{};
    double settle_band_percent = 0.5;  ///< the one that fits the paper's figures (docs/theory.md)
    OutsideRule below = OutsideRule::pass;
    OutsideRule above = OutsideRule::hold;
    /// A band is left only when |v| is this far outside it, so that it is in force, and measured, as far.
    DegPerSec hysteresis{0.0};
};

/// Bands of equal width, e.g. 18:180:18. Throws UsageError on an empty, backward, non-finite or uneven range.
[[nodiscard]] std::vector<std::pair<DegPerSec, DegPerSec>> bands_by_spacing(const SpeedSpan& speeds,
                                                                            DegPerSec spacing);

/// The speeds at which a band of this range can be in force, its hysteresis included; multiplied by the share
/// by which the gear ratio may be off, since that moves the lines alike.
[[nodiscard]] std::pair<double, double> speeds_in_force(const TableSpec& spec, double from_deg_s,
                                                        double to_deg_s);

/// Throws UsageError unless everything in `spec` but its bands and notches makes sense.
void check_ripple(const TableSpec& spec);

/// Fills in what follows from a band's edges and notches: dc_delay, settle, overshoot_percent, and how far
/// the whole cascade attenuates the line of each order, over speeds from..to, the hysteresis beyond them, and
/// gear ratios within ratio_error.
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

// What holds at which speed: the bands of a table, and the rules for what lies below, between and above them.

/// Active when no candidate is: the torque passes.
inline constexpr int no_candidate = -1;

/// A range of speed in which one rule holds: from < |v| <= to.
struct SpeedRegion {
    double from_deg_s = 0.0, to_deg_s = 0.0;
    int candidate = no_candidate;  ///< index into the table's bands; no_candidate
    bool holds = false;            ///< the active candidate stays, whichever it is
    /// Share of the filtered signal in the output: 1 but where the rule fades. It falls linearly from 1 at
    /// full_deg_s to 0 at none_deg_s and stays 0 beyond; both equal means 1 everywhere.
    double full_deg_s = 0.0, none_deg_s = 0.0;

    [[nodiscard]] double share(double speed_deg_s) const noexcept;
    [[nodiscard]] bool fades() const noexcept { return full_deg_s != none_deg_s; }
    /// As exported code has it: the candidate, -1 where the torque passes, -2 where the active one stays.
    [[nodiscard]] int code() const noexcept { return holds ? -2 : candidate; }
};

/// All speeds from 0 up, without holes. `fade` reaches from the edge of a band to half that speed below the
/// first band, to one and a half times that speed above the last, and to the middle of a hole.
[[nodiscard]] std::vector<SpeedRegion> speed_regions(std::span<const std::pair<DegPerSec, DegPerSec>> bands,
                                                     OutsideRule below, OutsideRule above);
[[nodiscard]] std::vector<SpeedRegion> speed_regions(std::span<const Band> bands, OutsideRule below,
                                                     OutsideRule above);

// A line near half the sample rate can be neither notched nor distinguished from its mirror image: methods
// that follow the ripple fade out before it gets there, all in the same way.

/// In cycles a sample: up to the first a line is removed completely, from the second on not at all.
inline constexpr double full_below_rate = 0.45, none_above_rate = 0.48;

/// The share of a line at this frequency, in cycles a sample, that is removed.
[[nodiscard]] inline double share_below_rate(double cycles) noexcept {
    return std::clamp((none_above_rate - cycles) / (none_above_rate - full_below_rate), 0.0, 1.0);
}

// The cost of measuring the bands of a table, estimated beforehand, so that no table takes unreasonably long.

constexpr std::size_t max_bands = 10000;  ///< chosen, not derived: docs/reliability.md
constexpr std::size_t most_orders = 64;   ///< chosen, not derived: docs/reliability.md

/// Adds up the work of measure_band(). A table that can be designed can be read again: both use this check.
class TableWork {
  public:
    /// Throws UsageError when the bands added so far take more than about a second together.
    void add(const Band& band, double settle_band_percent);

  private:
    std::size_t bands_ = 0;
    double responses_ = 0.0, steps_ = 0.0;
};

}  // namespace ripplenotch
