// SPDX-License-Identifier: MIT
#pragma once
// A ripple map from logs of one joint: its form by cross-validation, shrunk where the logs determine little,
// with the error of each value and the residual on blocks that it was not fitted to.

#include <complex>
#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "ripplenotch/core/gear_account.hpp"
#include "ripplenotch/core/trace.hpp"
#include "ripplenotch/design/ripple_map.hpp"
#include "ripplenotch/filter/method.hpp"

namespace ripplenotch {

/// Cross-validated results of one requested order, whether or not it is in the map. All values are from
/// blocks of the logs that the map was not fitted to.
struct MapOrderScore {
    double order = 0.0;
    bool in_map = false;
    double ripple_nm = 0.0;        ///< rms over windows of the amplitude (zero to peak), noise included
    double noise_nm = 0.0;         ///< the same half an order to its sides, where no ripple is
    double left_nm = 0.0;          ///< the same of the residual after subtraction of the map
    double predicted_share = 0.0;  ///< share of the ripple's energy above the noise; 0 to 1
    double false_alarm = 1.0;      ///< probability that chance is as regular
    /// For an order that is not in the map: the amplitude that would have been found in 20 of 20 such logs.
    double detectable_nm = 0.0;
};

/// By how much the ripple of one log is that of all the other logs, as a map of these alone has it.
struct MapAgreement {
    std::size_t log = 0;
    double order = 0.0;
    double amplitude_ratio = 1.0, amplitude_error = 0.0;
    double phase_deg = 0.0, phase_error_deg = 0.0;  ///< phase lead of its ripple
    bool agrees = true;                             ///< within three of its errors, or 15 %
};

enum class MapFinding { mapped, nothing, unclear, too_little };
[[nodiscard]] std::string_view map_finding_name(MapFinding finding);

struct MapFit {
    RippleMap map;  ///< empty unless `mapped`
    /// By order of the map, then by column: standard errors of cosine (real) and sine part (imaginary), Nm.
    std::vector<std::vector<std::complex<double>>> errors;
    std::vector<MapOrderScore> scores;  ///< scores of every order requested
    std::vector<MapAgreement> agreement;
    MapFinding finding = MapFinding::too_little;
    double false_alarm = 1.0;  ///< probability that chance is as regular at any or all of the orders
    std::size_t windows = 0, blocks = 0;
    bool anchored = true;     ///< the angle is that of a position; else it counts from the first row
    bool conclusive = false;  ///< mapped or nothing, anchored, and the logs agree
    std::string doubt;        ///< stated before the verdict, from the code that read the logs; empty: none
    std::vector<std::string> notes;  ///< one sentence each
    std::vector<MapFit> others;      ///< of the motors of other joints (fit_joint_map), named by map.joint
};

/// Probability that a log without ripple has a map.
inline constexpr double map_false_alarm = 0.01;

/// Fewer windows are not enough to leave some out.
inline constexpr std::size_t fewest_map_windows = 12;

/// Fits each order in windows of 2.5 periods of the lowest one along with a cubic trend, then
/// the windows' amplitudes by ridge regression on the columns of a form. An order is included in the map
/// where a rotation test finds it, at 1 % for all orders together; the form is the smallest one that
/// cross-validation does not distinguish from the best.
/// Angles count from `zero_deg`. Logs without a position have none to count from: throws DataError for
/// several of them. Throws UsageError for no log.
[[nodiscard]] MapFit fit_ripple_map(std::span<const TraceView> logs, const GearAccount& gear,
                                    double zero_deg = 0.0, double false_alarm = map_false_alarm);

/// Another joint of the same arm, whose motor may put ripple into this joint's torque.
struct OtherMotor {
    std::string joint;
    GearAccount gear;
    std::vector<TraceView> motion;  ///< by log: its rows are those of the torque; with a position
};

/// A map of what a joint's torque holds of its own motor and, in `others`, of each other motor, in their
/// order. Each is fitted to the torque less all other maps, until they stay (backfitting, Breiman and
/// Friedman 1985). `own` null: its gear is not known; the map is then empty. That any other motor is mapped
/// of which nothing is in the torque has a probability of 1 % for all `pairs` of a torque and another motor
/// that are looked at in the log. A motor whose angle goes with that of a mapped one cannot be told from it
/// and is in its `doubt`. Throws what fit_ripple_map throws.
[[nodiscard]] MapFit fit_joint_map(std::span<const TraceView> logs, const GearAccount* own,
                                   std::span<const OtherMotor> others, std::size_t pairs,
                                   double zero_deg = 0.0);

/// The torques of these logs less the ripple of the other motors that are in the map, by log.
[[nodiscard]] std::vector<std::vector<double>> without_other_motors(std::span<const TraceView> logs,
                                                                    const RippleMap& map,
                                                                    std::span<const OtherMotor> others);

/// The ripple that a map predicts along a log of its motor's joint, Nm by row.
[[nodiscard]] std::vector<double> map_along(const RippleMap& map, const TraceView& log);

/// A filter whose output is the ripple that the map predicts, whatever the torque.
[[nodiscard]] std::unique_ptr<CausalFilter> map_prediction(const RippleMap& map, Hertz sample_rate);

/// "by speed (5 of them) and direction, with the second comb at n (Kg + 1)"
[[nodiscard]] std::string map_form_words(const MapForm& form);
/// The meaning of `column`: "forward, 10 deg/s", "backward, any speed, second comb".
[[nodiscard]] std::string map_column_words(const MapForm& form, std::size_t column);

/// One sentence with numbers.
[[nodiscard]] std::string map_verdict(const MapFit& fit);

/// The keys of a method that map=map.json abbreviates: gear-ratio (where it is known), orders, cosines, sines
/// and the others that the form needs, in the order of the page; angles count from position 0 then. The map
/// has an order.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> map_as_keys(const RippleMap& map);

}  // namespace ripplenotch
