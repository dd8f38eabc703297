// SPDX-License-Identifier: MIT
#pragma once
// How wide a band of speed one set of notches can serve: the searches behind a designed table. Gains are
// those of the sampled sections in closed form, which is what makes thousands of trial bands cheap; the table
// that comes out is measured again on its own coefficients.

#include <optional>
#include <utility>
#include <vector>

#include "ripplenotch/design/candidate_table.hpp"
#include "ripplenotch/design/guarantee.hpp"

namespace ripplenotch {

/// The narrowest and the widest notch that a search may use: the paper's twin-T, and one whose transient
/// lasts three periods of its line (4.E of the design notes: 2 % settling of a pair at Q 5).
inline constexpr double widest_q = 0.25, narrowest_q = 5.0;

/// How Q is chosen for a centre: stated, or as low as a delay allows (never below widest_q).
struct QRule {
    std::optional<double> q;
    std::optional<double> delay_s;
};

/// Notches for one centre speed.
struct Tuning {
    double center_deg_s = 0.0;
    double q = widest_q;
    std::vector<double> warped;  ///< tan(pi f / fs) at the centres
};

class BandFit {
  public:
    /// `spec` without bands; its gear ratio, orders, rate, depth and ratio_error count. Q is that of the
    /// analogue prototype.
    explicit BandFit(const TableSpec& spec);

    /// Empty when the rule's delay cannot be met with narrowest_q.
    [[nodiscard]] std::optional<Tuning> tune(double center_deg_s, const QRule& rule) const;
    /// The largest gain of the ripple over from..to and the interval of the gear ratio: of the line that is
    /// attenuated least.
    [[nodiscard]] double worst_gain(const Tuning& tuning, double from_deg_s, double to_deg_s) const;
    /// Whether that is at most `max_gain`.
    [[nodiscard]] bool holds(const Tuning& tuning, double from_deg_s, double to_deg_s, double max_gain) const;
    [[nodiscard]] double delay_s(const Tuning& tuning) const;

    /// Highest speed up to which a band from `from` can reach, `end` at most; empty when not even its own
    /// lower edge is held.
    [[nodiscard]] std::optional<double> reach(double from_deg_s, double end_deg_s, double max_gain,
                                              const QRule& rule) const;
    /// The centre at which the band's two edges are attenuated alike.
    [[nodiscard]] std::optional<Tuning> balanced(double from_deg_s, double to_deg_s, const QRule& rule) const;
    /// Smallest number of bands by extending each as far as it goes; their edges, lowest first. Empty when it
    /// takes more than `most`, or some speed cannot be held at all.
    [[nodiscard]] std::optional<std::vector<double>> edges(double from_deg_s, double to_deg_s,
                                                           double max_gain, const QRule& rule,
                                                           std::size_t most) const;

  private:
    /// Square of the gain at one speed, with the nominal gear ratio.
    [[nodiscard]] double power(const Tuning& tuning, double speed_deg_s) const;
    [[nodiscard]] double speed_in(double from_deg_s, double to_deg_s, int point) const;
    [[nodiscard]] double warped(std::size_t order, double speed_deg_s) const;

    const TableSpec& spec_;
    std::vector<double> hz_per_deg_s_;
    double floor_gain_;  ///< at a notch's centre
};

// The three-way trade of a designed table, attenuation, delay and number of bands: any two give the third.

inline constexpr std::size_t max_bands_ever = 1000;   // chosen, not derived: bounds the time
inline constexpr double gain_worth_a_band_db = 0.25;  // chosen, not derived
/// Loss of attenuation by rounding of edges and Q; searches aim this much higher.
inline constexpr double rounding_db = 0.002;

class BandSearch {
  public:
    /// `spec` (kept by reference) without bands; covers goal.from .. goal.to with Q by `goal.q`, if stated.
    BandSearch(const TableSpec& spec, const DesignGoal& goal);

    [[nodiscard]] const BandFit& fit() const { return fit_; }
    [[nodiscard]] QRule rule(std::optional<double> delay_s) const;
    /// Fewest bands; empty when no number (up to max_bands_ever) holds it.
    [[nodiscard]] std::optional<std::size_t> bands(double attenuation_db, const QRule& rule) const;
    /// Largest attenuation that so many bands hold; empty when they hold less than 0.1 dB. `known_db` may
    /// give an attenuation that they certainly hold, to begin from; the attenuation `held_db` is assumed to
    /// hold without a test and does not change the result.
    [[nodiscard]] std::optional<double> attenuation_db(std::size_t bands, const QRule& rule,
                                                       double known_db = 0.0, double held_db = 0.0) const;
    /// As many bands as add gain_worth_a_band_db each.
    [[nodiscard]] std::size_t bands_worth_it(const QRule& rule) const;

    struct Settling {
        double delay_s = 0.0, settle_s = 0.0, q = 0.0;
    };
    /// The notches at the lowest speed whose step response settles soonest.
    [[nodiscard]] Settling soonest() const;
    /// Delay at the lowest speed of the narrowest notches.
    [[nodiscard]] double min_delay_s() const { return fit_.delay_s(*fit_.tune(from_, {narrowest_q, {}})); }

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
