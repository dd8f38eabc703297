// SPDX-License-Identifier: MIT
#pragma once
// Where a model of a joint and a measured log disagree, which effect of the catalogue is missing, and how far
// the gap shrinks when it is added.

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "ripplenotch/core/trace.hpp"
#include "ripplenotch/diagnose/setup.hpp"
#include "ripplenotch/model/fit.hpp"
#include "ripplenotch/model/model.hpp"
#include "ripplenotch/model/motion.hpp"
#include "ripplenotch/model/setup_fault.hpp"

namespace ripplenotch {

/// How sure a finding is. Only confirmed ones are named.
enum class FindingStatus {
    confirmed,
    ambiguous,         ///< another effect explains the log as well
    tentative,         ///< an unexplained region depends on the same variable
    immaterial,        ///< there, and too small to matter
    shape_correction,  ///< mends the form of a larger finding
    /// Two large torques that cancel, or a size within its error: not determined by this log.
    unidentifiable,
    not_reproduced,  ///< the validation log is predicted worse with it than without
};
[[nodiscard]] std::string_view status_name(FindingStatus status);

enum class DiagnosisVerdict {
    matches,           ///< the model explains the log: nothing is missing
    explained,         ///< it does with what was named, or with either side of a tie
    partly_explained,  ///< something was named, something is left
    unexplained,       ///< something is left that no effect explains
    /// Another interpretation of the log, equally possible, gives another result: see Diagnosis::doubt.
    undecided,
};
[[nodiscard]] std::string_view verdict_name(DiagnosisVerdict verdict);

struct Span {
    double from = 0.0, to = 0.0;
    bool operator==(const Span&) const = default;
};

enum class Direction {
    at_rest_too,  ///< in none in particular, and at standstill
    positive,
    negative,
    both,  ///< wherever it moves
};
/// "positive", "negative", "both"; empty for at_rest_too.
[[nodiscard]] std::string_view direction_name(Direction direction);

/// Where in a log something acts. Empty lists: nowhere in particular.
struct Place {
    std::vector<Span> time_s, speed_deg_s, position_deg;
    std::vector<double> hz, order;  ///< order: cycles per motor revolution
    Direction direction = Direction::at_rest_too;
    std::vector<double> order_output = {};  ///< cycles per output revolution, where no gear ratio is known
};

/// The evidence for a finding.
struct Evidence {
    double gain =
        0.0;  ///< fall of the sum of squares in units of the noise's variance, without it less with it
    double price = 0.0;        ///< gain that chance might bring, given all that was tried
    double share_nm = 0.0;     ///< rms torque that only this finding explains
    double share_sigma = 0.0;  ///< the same in units of the noise floor
    double own_nm = 0.0;       ///< rms of its whole torque, of which others might explain a part as well
    double sized_nm = 0.0;     ///< the same of its size alone, without a number that acts where the size is 0
    double raw_gain = 0.0;     ///< fall of the sum of squares of the residual, Nm^2
    double elsewhere = 0.0;    ///< part of the gain that is left without its best stretch of the log
    double t = 0.0;            ///< the gain in units of its own standard error over blocks of the log
    std::size_t blocks = 0,
                blocks_positive = 0;  ///< blocks of a second or more; those with a reduction of squares
};

/// A rival that is behind by less is not told from a finding: 400 to 1 were both as likely.
inline constexpr double tie_margin = 12.0;
/// Fewer samples do not distinguish noise from torque: the log is refused.
inline constexpr std::size_t fewest_samples_diagnosed = 200;

struct RivalFinding {
    std::string_view effect;
    double margin = 0.0;  ///< gain by which the finding is ahead of it
};

/// A candidate that the search did not add in its last step.
struct RefusedCandidate {
    Term term;  ///< with the values that were tried
    std::string reason;
};

/// One effect that was added, in the order of adoption.
struct Finding {
    Term term;  ///< with its values
    FindingStatus status = FindingStatus::confirmed;
    std::vector<FittedValue> values;  ///< its fitted parameters
    Place where;
    Evidence evidence;
    std::vector<RivalFinding> alternatives;
    double gap_before_nm = 0.0, gap_after_nm = 0.0;
    /// rms residual of the validation log, without it and with it, together with all accepted findings.
    std::optional<double> validation_before_nm, validation_after_nm;
    std::string reason;  ///< reason of a status other than confirmed, as text
};

/// Effects between which this log does not decide.
struct Tie {
    std::vector<std::string> effects;
    std::string advice;  ///< the experiment that would
};

/// The variable in which a region is confined.
enum class RegionKind { time, tone, order, position, speed };
[[nodiscard]] std::string_view region_kind_name(RegionKind kind);

/// Something that no effect of the catalogue explains.
struct ResidualRegion {
    RegionKind kind = RegionKind::time;
    Place where;
    double rms_nm = 0.0;  ///< within the place
    double part = 0.0;    ///< share of the squared residual of the whole log
};

/// An effect that is not examined: this log does not let it be, or the gear ratio is not known.
struct Undecidable {
    std::string_view effect;
    std::string reason;
    double would_explain_nm = 0.0;  ///< rms torque, under the assumption made for the missing measurement
};

/// A fault of the converter that was seen in the log itself.
struct Fault {
    Term term;  ///< term of a converter effect
    std::size_t samples = 0;
    std::vector<Span> time_s;
    std::string words;
};

/// The torque of a log in a band of frequencies: all of it less its mean, the residual of the known terms,
/// and that of the known terms and the improved model.
struct BandGap {
    double from_hz = 0.0, to_hz = 0.0;  ///< 0: up to half the sample rate
    double torque_nm = 0.0, beside_given_nm = 0.0, after_nm = 0.0;
};

/// A finding that is uncertain from this log and that the user takes into the model.
struct AcceptedFinding {
    Term term;                                        ///< with its values, of the last fit
    FindingStatus status = FindingStatus::tentative;  ///< before
    std::string reason;                               ///< reason against it
    std::vector<FittedValue> values;
};

/// A value of a given term.
struct GivenValue {
    std::string name;  ///< name of the term
    double value = 0.0;
    std::optional<Interval> ci95;
};

struct DiagnosisGap {
    double before_nm = 0.0, after_nm = 0.0;  ///< rms of measured less predicted torque, samples in order
    double noise_floor_nm = 0.0;
    /// Share of the squared gap above the floor that was closed; empty when there was none.
    std::optional<double> closed_percent;
    std::optional<double> validation_before_nm, validation_after_nm, validation_closed_percent;
};

/// The correction of the angle from the ripple, where a log has no position.
struct AngleAccount {
    double walk_deg = 0.0;  ///< rms by which the integral of the log's velocity was moved, less its mean
    /// Where the validation log begins, in the angle of the log; empty where both have a position.
    std::optional<double> validation_start_deg;
};

/// Rows of the log that nothing is fitted to.
struct UnusedRows {
    std::string reason;
    std::size_t rows = 0;
};

/// An effect that acts mainly in rows that nothing is fitted to.
struct EffectOfUnusedRows {
    std::string effect;
    std::size_t rows = 0, unused = 0;  ///< rows in which it acts, and how many of these are unused
};

struct Diagnosis {
    DiagnosisVerdict verdict = DiagnosisVerdict::matches;
    Model baseline;  ///< the model as given, with the values that were fitted to it alone
    Model model;     ///< the improved one: with the findings, except tentative or unidentifiable ones
    std::vector<FittedValue> values;  ///< every fitted value of the improved model
    std::vector<Finding> rounds;
    std::vector<RefusedCandidate> refused;
    std::vector<Fault> faults;
    std::vector<std::string> named;
    std::string doubt;  ///< one sentence, where the verdict is undecided
    std::vector<Tie> ambiguous;
    std::vector<ResidualRegion> unexplained;
    std::vector<Undecidable> undecidable;
    DiagnosisGap gap;
    std::vector<GivenValue> given;  ///< values of the given terms, in their order
    /// With known terms: measured less predicted torque of the model as given and of the improved one, an
    /// entry per row of the log. Empty without known terms: a model's own prediction gives it then.
    std::vector<double> residual_before_nm, residual_after_nm;
    std::vector<double> beside_given_nm;  ///< with known terms: torque less their contribution, as fitted
    std::vector<BandGap> bands;           ///< with known terms
    std::vector<AcceptedFinding> accepted;
    std::vector<std::string> not_accepted;  ///< why a name is not, a sentence each
    std::vector<std::string> next;          ///< what to do where something is uncertain, a sentence each
    /// Faults of the set-up, which call every name into question; the first to repair comes first.
    std::vector<SetupFault> setup;
    /// How far the log is behind the user's simulation, where their motions show it. The known torque is
    /// shifted by that: it is no effect of the model.
    std::optional<SimulationLag> alignment;
    bool residual_in_noise = false;  ///< names were weighed against noise that holds what nothing explains
    std::vector<ResidualRegion>
        disagreement;  ///< where the model as given and the log disagree, largest first
    std::size_t samples = 0, samples_used = 0;
    std::vector<UnusedRows> unused;                     ///< with those of `samples_used` all samples
    std::vector<EffectOfUnusedRows> acts_where_unused;  ///< effects that were tried
    /// Evaluations of a model along the samples searched, and whether the search was ended for their number.
    double evaluations = 0.0;
    bool search_ended = false;
    bool has_position = false;
    std::optional<AngleAccount> angle;  ///< where the log or the validation log has no position
    std::vector<double> noise_color;    ///< a1 ... ap of FitOptions::noise_color
    double false_alarm = 0.01;          ///< chance that a log with nothing hidden gets a name, by design
};

struct DiagnosisOptions {
    Seconds smoothing = default_smoothing;
    std::span<const std::string> without = {};  ///< names of effects that are not tried
    /// Names of findings that are taken into the model although the log leaves them uncertain; used by
    /// diagnose_in_full.
    std::span<const std::string> accept = {};
    /// Terms that are stated and not searched, a column per value and a row per row of the log; the same of
    /// the validation log, where there is one.
    std::span<const GivenTerm> given = {}, validation_given = {};
    /// Faults of the set-up that are known beforehand. The known terms are wrong then, so that no name is
    /// confirmed.
    std::span<const SetupFault> setup = {};
    bool others_move = false;  ///< joints of the same arm, whose torque on this one no term holds
    /// A delay at which the search for one begins as well.
    std::optional<Seconds> expected_delay = {};
};

/// Diagnoses a log of at least fewest_samples_diagnosed. `validation` is another log that nothing is
/// fitted to; it may be absent. Throws UsageError: an unknown name in `without`, a
/// model whose lines are not stated; DataError: a log too short, or without motion.
[[nodiscard]] Diagnosis diagnose(const Model& model, const TraceView& log, const TraceView* validation,
                                 const DiagnosisOptions& options = {});

/// diagnose(), then once more with what the user accepts as a part of the model, its values open: gap and
/// disagreement are those before that. A name that is neither uncertain nor a side of a tie is reported in
/// `not_accepted`. `next` and `bands` are filled in, too. Throws as diagnose().
[[nodiscard]] Diagnosis diagnose_in_full(const Model& model, const TraceView& log,
                                         const TraceView* validation, const DiagnosisOptions& options = {});

}  // namespace ripplenotch
