// SPDX-License-Identifier: MIT
#pragma once
// How wide a band of speed one set of notches can serve: the searches behind a designed table. Gains are
// those of the sampled sections in closed form, which is what makes thousands of trial bands cheap; the table
// that comes out is measured again on its own coefficients.

#include <optional>
#include <utility>
#include <vector>

#include "ripplenotch/design/candidate_table.hpp"

namespace ripplenotch {

/// The narrowest and the widest notch that a search may take: the paper's twin-T, and one that rings for
/// three periods of its line (4.E of the design notes: 2 % settling of a pair at Q 5).
inline constexpr double widest_q = 0.25, narrowest_q = 5.0;

/// How Q is chosen for a centre: stated, or as low as a delay allows (never below widest_q).
struct QRule {
    std::optional<double> q;
    std::optional<double> delay_s;
};

/// Notches for one centre speed: their Q per order.
struct Tuning {
    double center_deg_s = 0.0;
    std::vector<double> q;
    std::vector<double> warped;   ///< tan(pi f / fs) at the centres
    std::vector<double> damping;  ///< 1/Q of the analogue filter that the sampled one is the image of
};

class BandFit {
  public:
    /// `spec` without bands; its gear ratio, orders, rate, depth, width, ratio_error and amplitudes count.
    /// With `shaped` each order gets a Q of its own, by its amplitude, within widest_q and narrowest_q;
    /// without it all have the rule's.
    BandFit(const TableSpec& spec, bool shaped);

    /// Empty when the rule's delay cannot be met with narrowest_q.
    [[nodiscard]] std::optional<Tuning> tune(double center_deg_s, const QRule& rule) const;
    /// The largest gain of the ripple over from..to and the interval of the gear ratio: of all orders by
    /// their amplitudes, else of the line that is attenuated least.
    [[nodiscard]] double worst_gain(const Tuning& tuning, double from_deg_s, double to_deg_s) const;
    /// Whether that is at most `most_gain`.
    [[nodiscard]] bool holds(const Tuning& tuning, double from_deg_s, double to_deg_s,
                             double most_gain) const;
    [[nodiscard]] double delay_s(const Tuning& tuning) const;

    /// Highest speed up to which a band from `from` can reach, `end` at most; empty when not even its own
    /// lower edge is held.
    [[nodiscard]] std::optional<double> reach(double from_deg_s, double end_deg_s, double most_gain,
                                              const QRule& rule) const;
    /// The centre at which the band's two edges are attenuated alike.
    [[nodiscard]] std::optional<Tuning> balanced(double from_deg_s, double to_deg_s, const QRule& rule) const;
    /// Smallest number of bands by extending each as far as it goes; their edges, lowest first. Empty when it
    /// takes more than `most`, or some speed cannot be held at all.
    [[nodiscard]] std::optional<std::vector<double>> edges(double from_deg_s, double to_deg_s,
                                                           double most_gain, const QRule& rule,
                                                           std::size_t most) const;

  private:
    [[nodiscard]] Tuning tuned(double center_deg_s, double q) const;
    [[nodiscard]] double q_each(std::size_t order, double q) const;
    struct Centre {
        double warped;            ///< tan(pi f / fs)
        double half_angle, sine;  ///< pi f / fs and the sine of its double, for the digital rule
    };
    [[nodiscard]] Centre centre(double warped) const;
    [[nodiscard]] double damping(const Centre& centre, double q) const;
    [[nodiscard]] double least_q(const std::vector<Centre>& centres) const;
    /// Square of the gain at one speed, with the nominal gear ratio.
    [[nodiscard]] double power(const Tuning& tuning, double speed_deg_s) const;
    [[nodiscard]] double speed_in(double from_deg_s, double to_deg_s, int point) const;
    [[nodiscard]] double warped(std::size_t order, double speed_deg_s) const;
    [[nodiscard]] double delay_samples(double warped, double damping) const;

    const TableSpec& spec_;
    bool shaped_;
    std::vector<double> shape_;   ///< Q of each order relative to the rule's
    std::vector<double> weight_;  ///< share of each order in the ripple's power; empty without amplitudes
    std::vector<double> hz_per_deg_s_;
    double floor_gain_;  ///< at a notch's centre
};

}  // namespace ripplenotch
