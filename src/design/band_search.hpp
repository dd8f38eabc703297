// SPDX-License-Identifier: MIT
#pragma once
// The three-way trade of a designed table, attenuation, delay and number of bands: any two give the third.

#include <limits>
#include <optional>
#include <vector>

#include "design/band_fit.hpp"
#include "ripplenotch/design/guarantee.hpp"

namespace ripplenotch {

inline constexpr std::size_t most_bands_ever = 1000;  // by hand: bounds the time
inline constexpr double gain_worth_a_band_db = 0.25;  // by hand
/// What rounding of edges and Q may take off an attenuation; searches aim this much higher.
inline constexpr double rounding_db = 0.002;

inline constexpr double delay_as_exact = 1e-4;  ///< share of a delay to which it is searched

class BandSearch {
  public:
    /// `spec` (kept by reference) without bands; covers goal.from .. goal.to with Q by `goal.q`, if stated.
    BandSearch(const TableSpec& spec, const DesignGoal& goal);

    [[nodiscard]] const BandFit& fit() const { return fit_; }
    [[nodiscard]] QRule rule(std::optional<double> delay_s) const;
    /// Fewest bands; empty when no number (up to most_bands_ever) holds it.
    [[nodiscard]] std::optional<std::size_t> bands(double attenuation_db, const QRule& rule) const;
    /// Most attenuation that so many bands hold; empty when they hold less than 0.1 dB. `known_db` may give
    /// an attenuation that they surely hold, to begin from; what is told to be held, `held_db`, is not looked
    /// at again, and changes nothing of what is found.
    [[nodiscard]] std::optional<double> attenuation_db(std::size_t bands, const QRule& rule,
                                                       double known_db = 0.0, double held_db = 0.0) const;
    /// Delays that are known to be too short and to be enough: not looked at again.
    struct KnownDelays {
        double short_s = 0.0, enough_s = std::numeric_limits<double>::infinity();
    };
    /// Least delay with which so many bands hold it, up to delay_as_exact; empty when they do not with any.
    [[nodiscard]] std::optional<double> delay_s(double attenuation_db, std::size_t bands,
                                                KnownDelays known) const;
    /// As many bands as add gain_worth_a_band_db each.
    [[nodiscard]] std::size_t bands_worth_it(const QRule& rule) const;

    struct Settling {
        double delay_s = 0.0, settle_s = 0.0, q = 0.0;
    };
    /// Of notches at the lowest speed, those whose step response settles soonest.
    [[nodiscard]] Settling soonest() const;
    /// Delay at the lowest speed of the narrowest and of the widest notches.
    [[nodiscard]] double least_delay_s() const { return fit_.delay_s(*fit_.tune(from_, {narrowest_q, {}})); }
    [[nodiscard]] double most_delay_s() const { return fit_.delay_s(*fit_.tune(from_, {widest_q, {}})); }

    /// The bands that hold `attenuation_db`, as a measured table.
    [[nodiscard]] CandidateTable table(double attenuation_db, const QRule& rule) const;

  private:
    TableSpec spec_;
    BandFit fit_;
    double from_, to_;
    std::optional<double> q_;
};

/// A band with its notches as they are written: Q to seven digits, never so that it delays more.
[[nodiscard]] Band band_of(const TableSpec& spec, int number, DegPerSec from, DegPerSec to,
                           const Tuning& tuning);

}  // namespace ripplenotch
