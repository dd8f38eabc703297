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

#include "ripplenotch/analysis/amplitude_by_speed.hpp"
#include "ripplenotch/analysis/velocity_error.hpp"
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
    std::vector<double> could_be;  ///< other output orders that explain the line about as well, by folding
    std::optional<double> hz;      ///< for kind tone, and the seen frequency of a single-speed line
    double amplitude_nm = 0.0;     ///< zero to peak, mean over the stretches that show it
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

struct RatioCandidate {
    double value = 0.0;
    double score = 0.0;  ///< 0..1, sums to at most 1 over the candidates
    std::string reason;
    bool other_unit = false;  ///< only if the motion is in another unit than it was read in
};

/// Gear ratio from f = n Kg |v| / 360.
struct GearRatioFit {
    std::optional<double> value;  ///< empty when nothing supports one
    double standard_error = 0.0;
    double ci95_low = 0.0, ci95_high = 0.0;
    /// Turns of the wave generator against the other spline, value + 1 or value - 1, where lines lie on its
    /// multiples as well.
    std::optional<double> second_comb;
    bool coarse = false;  ///< ci95 holds ratios one apart, as those of both splines are; not in joint.json
    std::vector<RatioCandidate> candidates;  ///< likeliest first
    /// One entry per line used: its mean speed, its frequency there and the residual of the fit, in hertz.
    struct Residual {
        double speed_deg_s = 0.0, hz = 0.0, order = 0.0, residual_hz = 0.0, weight = 1.0;
    };
    std::vector<Residual> residuals;
};

/// Ratios between which nothing decides, the most probable first; empty where there is a value, or where no
/// ratio is probable.
[[nodiscard]] std::vector<double> undecided_ratios(const GearRatioFit& fit);

/// Fixed tones that are multiples of one frequency.
struct ToneFamily {
    double hz = 0.0, hz_stderr = 0.0;
    std::vector<int> multiples;  ///< ascending
};

/// A band of frequencies outside the lines with more torque in it than the strongest ripple line has.
struct Hum {
    double from_hz = 0.0, to_hz = 0.0;
    double peak_hz = 0.0;
    double rms_nm = 0.0;  ///< rms in the band, noise subtracted, largest of the stretches or rms over sweeps
};

/// The estimates of one quantity from recordings of one joint that disagree beyond their errors.
struct Disagreement {
    enum class About { ratio, amplitude, phase };
    struct Value {
        std::size_t recording = 0;        ///< as handed over, from 0
        double value = 0.0, error = 0.0;  ///< a ratio, Nm, or deg
    };
    About about = About::ratio;
    std::optional<double> order, order_output;  ///< order of the line, for amplitudes and phases
    std::vector<Value> values;                  ///< by recording
    double chance = 1.0;                        ///< probability that recordings which agree differ as much
};
[[nodiscard]] std::string_view about_name(Disagreement::About about);

/// Output orders that were searched, and the amplitude that a line at any of them would have been found with,
/// in 95 of 100 logs. Where lines were found it holds for further ones.
struct SearchedOrders {
    double lowest_order = 0.0, highest_order = 0.0;  ///< cycles per output turn
    double detectable_nm = 0.0;                      ///< zero to peak, the largest of the range
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
    std::vector<ToneFamily> families;
    std::vector<Hum> hums;  ///< most torque first
    std::vector<Disagreement> disagreements;
    AmplitudeBySpeed by_speed;               ///< of a known ratio; not from identify() itself
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
};

/// Cycles per motor turn of a line that follows the motor; empty for others. A line that was seen at one
/// speed has an order where identify assigned it one, because the gear ratio depends on it.
[[nodiscard]] std::optional<double> motor_order(const Line& line);

/// The gear that was found: the ratio and the orders of the lines that follow the motor. Empty where nothing
/// supports a ratio.
[[nodiscard]] std::optional<GearAccount> found_gear(const Identification& found);

/// The verdict as text, reasons against it first.
[[nodiscard]] std::string verdict_sentence(const Identification& found);

/// The largest amplitude of an order of a joint's motor, its own or another one, in the torque of `found`,
/// Nm. Empty where none was found, or where it may be of another motor as well.
[[nodiscard]] std::optional<double> motor_amplitude(const Identification& found, const std::string& motor);

/// The joints whose motors are in a matrix of these torques: those that were looked for, in the order of the
/// torques, then those whose own torques are not there. None where there is one torque only.
[[nodiscard]] std::vector<std::string> motors_in_matrix(std::span<const Identification> found);

/// What was found of the motors of other joints, a sentence; empty where nothing was.
[[nodiscard]] std::string other_motors_sentence(const Identification& found);

/// Retracts the orders and the gear ratio in `found` and records why: every line that would turn with the
/// joint becomes of kind unknown, with its frequencies. The ratios that it would fit stay listed.
void cast_doubt(Identification& found, Doubt doubt);

struct IdentifyOptions {
    std::optional<GearRatio> hint;   ///< checked against the lines
    std::vector<int> hinted_orders;  ///< n at which the strongest line is expected
    double false_alarm = 0.01;       ///< chance that a log of noise gives any line
    std::vector<Doubt> doubts;       ///< reasons against these logs that are known beforehand
};

inline constexpr std::size_t fewest_identify_samples = 64;  ///< chosen, not derived: as for a spectrum

/// Lines and gear ratio of one joint from one or many of its logs. Throws DataError only for logs that are
/// unusable as such (fewer than 64 samples).
[[nodiscard]] Identification identify(std::span<const TraceView> logs, const IdentifyOptions& options);

// The gear ratio Kg from the combs that output orders lie on: n Kg, where the wave generator turns against
// the spline that stands still, and n (Kg + 1) or n (Kg - 1) against the one that moves.

/// A line that turns with the joint.
struct OrderLine {
    double order_output = 0.0;
    double error = 0.0;  ///< standard error of order_output from the line's own noise
    double snr = 0.0;
    double amplitude_nm = 0.0;
    bool certain = true;        ///< false: it may also be a fixed tone
    double speed_deg_s = 0.0;   ///< mean, at which the residual is stated
    double shared_error = 0.0;  ///< relative standard error of the angle, which all lines have in common
};

struct GearRatioResult {
    GearRatioFit fit;
    /// The order of each line, per turn of the motor, under fit.value: n on the first comb, n (Kg +/- 1) / Kg
    /// on the second; empty where it lies off both.
    std::vector<std::optional<double>> order_of_line;
    std::vector<std::string> notes;
};

/// What is known in addition to the lines.
struct RatioQuestion {
    std::optional<GearRatio> hint{};
    std::span<const int> hinted_orders{};  ///< n at which the strongest line is assumed to lie
};

/// Ratios are compared by their posterior probability. A line lies on a tooth of a comb within its error, or
/// anywhere by chance, which is the less probable the more clearly it is seen; a tooth has the prior
/// probability of its n (1 to 32), so that a dense comb pays for what it explains by chance. Ratios have
/// equal prior probability in the logarithm from 1 to 320, more where a catalogue has them, and more near the
/// hint. Compared as well: no gear at all (whole orders of the shaft that was measured), no connection
/// between the lines, and a mistaken unit. The scores are these probabilities. The value is left empty unless
/// one ratio has at least 0.8 and explains two lines, or one and the hint. Fit: over the lines, by Huber's
/// weights (k = 1.345); where they scatter more than their errors make likely (1 %), that widens the
/// interval, by Student's t; the error that they share comes on top. Lines that both combs make up, too close
/// together to be separated, count with the distance between the combs as their error.
[[nodiscard]] GearRatioResult fit_gear_ratio(std::span<const OrderLine> lines, const RatioQuestion& question);

}  // namespace ripplenotch
