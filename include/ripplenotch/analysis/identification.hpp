// SPDX-License-Identifier: MIT
#pragma once

// Results of identify for a joint: ripple lines, the gear ratio, and a sentence that states it. "Nothing
// found" and "cannot be determined" are values of these types, not errors.

#include <algorithm>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "ripplenotch/analysis/gear_ratio.hpp"
#include "ripplenotch/analysis/ripple_estimate.hpp"
#include "ripplenotch/analysis/sweeps.hpp"
#include "ripplenotch/core/gear_account.hpp"
#include "ripplenotch/core/quantity.hpp"
#include "ripplenotch/core/trace.hpp"

namespace ripplenotch {

// The outcome of an identification, as values; its text is composed in one function, verdict_sentence.
//
// Another reason against a result is a name in DoubtReason and a Doubt from the code that detects it: in
// IdentifyOptions::doubts when it is known before the lines are looked for, with cast_doubt() when it follows
// from what was found. A finding under a doubt is no verdict: the sentence begins with "Cannot tell:" and the
// doubts, in the order in which they came, and the identification is not conclusive.

/// The overall result from the lines.
enum class RippleFinding {
    ratio,       ///< ripple that turns with the joint, and the gear ratio
    orders,      ///< ripple that turns with the joint; its gear ratio stays open
    one_speed,   ///< lines, all at one speed, where an order and a fixed tone look alike
    nothing,     ///< surely no ripple above SearchedOrders::detectable_nm in that range
    too_noisy,   ///< no line, but one of SearchedOrders::detectable_nm would be missed
    too_little,  ///< the joint is at standstill, or moves too little to determine anything
};
[[nodiscard]] std::string_view finding_name(RippleFinding finding);

/// Why the lines are not accepted, whatever they show.
enum class DoubtReason {
    clock,  ///< position, velocity and time contradict each other
    unit,   ///< the unit of the motion is not stated, and another suits the lines as well
};
[[nodiscard]] std::string_view doubt_name(DoubtReason reason);

struct Doubt {
    DoubtReason reason = DoubtReason::clock;
    std::string because;  ///< half a sentence, with what would settle it; no capital, no full stop
    bool operator==(const Doubt&) const = default;
};

/// The data that a verdict is based on.
struct Grounds {
    std::size_t sweeps = 0, rests = 0;  ///< pieces of motion in one direction, and of standstill
    double sweep_turns = 0.0;           ///< output turns that the sweeps cover
    double slowest_deg_s = 0.0, fastest_deg_s = 0.0;
    double false_alarm = 0.0;
};

enum class LineKind { order, tone, unknown };
[[nodiscard]] std::string_view line_kind_name(LineKind kind);

/// Amplitude (zero to peak) of a line in one steady stretch or speed range.
struct AmplitudeAtSpeed {
    double speed_deg_s = 0.0;  ///< signed mean
    double hz = 0.0;           ///< measured frequency
    double amplitude_nm = 0.0;
    double snr = 0.0;
};

struct Line {
    LineKind kind = LineKind::unknown;
    std::optional<double> order;         ///< cycles per motor revolution; only with a gear ratio
    std::optional<double> order_output;  ///< cycles per output revolution; not for tones
    std::optional<double> order_output_stderr;
    std::optional<double> hz;   ///< for kind tone, and the seen frequency of a single-speed line
    double amplitude_nm = 0.0;  ///< zero to peak, mean over the stretches that show it
    /// Phase in cos(order * motor angle + phase), angle from position where there is one.
    double phase_deg = 0.0;
    bool phase_known = false;
    double snr = 0.0;  ///< amplitude over the local noise amplitude
    double speed_from_deg_s = 0.0, speed_to_deg_s = 0.0;
    std::vector<AmplitudeAtSpeed> by_speed;
    std::string note;  ///< e.g. "mains", "seen at one speed only"
};

/// Where a line was seen: at one frequency or over a range of speeds. Empty when that is not known.
struct SeenFrequencies {
    double lowest_hz = 0.0, highest_hz = 0.0;
};
[[nodiscard]] std::optional<SeenFrequencies> seen_frequencies(const Line& line);

/// The estimates of one quantity from recordings of one joint that disagree beyond their errors.
struct Disagreement {
    enum class About { ratio, amplitude };
    struct Value {
        std::size_t recording = 0;        ///< as handed over, from 0
        double value = 0.0, error = 0.0;  ///< a ratio, or Nm
    };
    About about = About::ratio;
    std::optional<double> order, order_output;  ///< order of the line, for amplitudes
    std::vector<Value> values;                  ///< by recording
    double chance = 1.0;                        ///< probability that recordings which agree differ as much
};
[[nodiscard]] std::string_view about_name(Disagreement::About about);

/// Output orders that were searched, and the amplitude that a line at any of them would have been found with,
/// in 95 of 100 logs. Where lines were found it holds for further ones.
struct SearchedOrders {
    double lowest_order = 0.0, highest_order = 0.0;  ///< cycles per output turn
    double detectable_nm = 0.0;                      ///< zero to peak, the largest of the range
    /// Standard deviation of what was searched, without smooth part and lines; not in joint.json. A line of
    /// more than that would show in any case: a larger detectable_nm says nothing.
    double deviation_nm = 0.0;
    /// From this order on up to the highest, a smaller amplitude would have been found.
    struct Bound {
        double from_order = 0.0, detectable_nm = 0.0;
    };
    std::vector<Bound> bounds;  ///< ascending in order, the first for the whole range
};

/// What a joint's torque holds of the motor of another joint.
struct OtherMotorRipple {
    struct AtOrder {
        double order = 0.0;  ///< cycles per turn of that motor
        bool found = false;
        double amplitude_nm = 0.0, standard_error_nm = 0.0;  ///< zero to peak, where it was found
        /// Where it was not: would have been found in 20 of 20 such logs; empty where there is no bound.
        std::optional<double> detectable_nm;
    };
    std::string joint;
    GearRatio gear_ratio;
    std::vector<AtOrder> orders;
    std::string doubt;  ///< why it may be the ripple of another motor as well, a sentence; or empty

    [[nodiscard]] bool found() const {
        return std::any_of(orders.begin(), orders.end(), [](const AtOrder& one) { return one.found; });
    }
};

struct Identification {
    std::string joint;
    Hertz sample_rate;
    std::string evidence;     ///< "order spectrum"; empty without motion
    std::vector<Line> lines;  ///< strongest first
    GearRatioFit gear_ratio;
    /// The velocity error of a log without position, if ripple in changing motion determines it; the orders
    /// are corrected for it.
    std::optional<VelocityError> velocity_error;
    DegPerSec velocity_noise{0.0};  ///< standard deviation; of the log where it is largest
    std::vector<Disagreement> disagreements;
    std::vector<RippleAtSpeed> by_speed;     ///< of a known ratio; not from identify() itself
    std::optional<SearchedOrders> searched;  ///< empty where the motion allows no search
    /// Of each other joint of the logs whose gear ratio is known. What was found of them, without a doubt,
    /// was taken from the torque before the lines were searched.
    std::vector<OtherMotorRipple> other_motors;
    std::vector<std::string> other_motors_not_known;  ///< joints whose gear ratio is not known
    RippleFinding finding = RippleFinding::too_little;
    std::vector<Doubt> doubts;
    Grounds grounds;                 ///< not in joint.json
    std::string verdict;             ///< verdict_sentence of all this: one sentence with numbers
    std::vector<std::string> notes;  ///< tests that were made and why they failed, one sentence each
    bool conclusive = false;  ///< lines found and a ratio, or certainly nothing, and no reason against it

    /// A range was searched, and nothing in it is, or may be, ripple.
    [[nodiscard]] bool shows_no_line() const {
        return finding == RippleFinding::nothing || finding == RippleFinding::too_noisy;
    }
};

/// Cycles per motor turn of a line that follows the motor; empty for others. A line that was seen at one
/// speed has an order where identify assigned it one, because the gear ratio depends on it.
[[nodiscard]] std::optional<double> motor_order(const Line& line);

/// The gear that was found: the ratio and the orders of the lines that follow the motor. Empty where nothing
/// supports a ratio.
[[nodiscard]] std::optional<GearAccount> found_gear(const Identification& found);

/// The largest amplitude of an order of a joint's motor, its own or another one, in the torque of `found`,
/// Nm. Empty where none was found, or where it may be of another motor as well.
[[nodiscard]] std::optional<double> motor_amplitude(const Identification& found, const std::string& motor);

/// The joints whose motors are in a matrix of these torques: those that were looked for, in the order of the
/// torques, then those whose own torques are not there. None where there is one torque only.
[[nodiscard]] std::vector<std::string> motors_in_matrix(std::span<const Identification> found);

/// Retracts the orders and the gear ratio in `found` and records why: every line that would turn with the
/// joint becomes of kind unknown, with its frequencies. The ratios that it would fit stay listed.
void cast_doubt(Identification& found, Doubt doubt);

/// The verdict as text, reasons against it first.
[[nodiscard]] std::string verdict_sentence(const Identification& found);

/// What was found of the motors of other joints, a sentence; empty where nothing was.
[[nodiscard]] std::string other_motors_sentence(const Identification& found);

struct IdentifyOptions {
    std::optional<GearRatio> hint;   ///< checked against the lines
    std::vector<int> hinted_orders;  ///< n at which the strongest line is expected
    double false_alarm = 0.01;       ///< chance that a log of noise gives any line
    double highest_order = 2560.0;   ///< per output turn
    std::vector<Doubt> doubts;       ///< reasons against these logs that are known beforehand
};

inline constexpr std::size_t fewest_identify_samples = 64;  ///< chosen, not derived: as for a spectrum

/// Lines and gear ratio of one joint from one or many of its logs. Throws DataError only for logs that are
/// unusable as such (fewer than 64 samples).
[[nodiscard]] Identification identify(std::span<const TraceView> logs, const IdentifyOptions& options);

}  // namespace ripplenotch
