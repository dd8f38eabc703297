// SPDX-License-Identifier: MIT
#pragma once
// Which effects of the catalogue a model of a joint lacks, from one log, and how far the gap shrinks when
// they are added.

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "ripplenotch/core/driven_torque.hpp"
#include "ripplenotch/core/trace.hpp"
#include "ripplenotch/diagnose/setup.hpp"
#include "ripplenotch/model/fit.hpp"
#include "ripplenotch/model/model.hpp"
#include "ripplenotch/model/motion.hpp"
#include "ripplenotch/model/setup_fault.hpp"

namespace ripplenotch {

enum class FindingStatus {
    confirmed,
    ambiguous,       ///< in the model; another effect explains the log as well
    correction,      ///< in the model and not named: below what the log resolves, or what the user's side is
                     ///< uncertain by
    not_reproduced,  ///< not in the model: with it the gap of a log grows
    refused,         ///< not in the model: tried last, and not admitted; no finding
};
[[nodiscard]] std::string_view status_name(FindingStatus status);

enum class DiagnosisVerdict {
    matches,           ///< nothing is missing, and noise is left
    explained,         ///< noise is left with what was named, or with either side of a tie
    partly_explained,  ///< something was named, something is left
    unexplained,       ///< nothing was named, something is left
    /// Another interpretation of the log, equally possible, gives another result: see Diagnosis::doubt.
    undecided,
};
[[nodiscard]] std::string_view verdict_name(DiagnosisVerdict verdict);

struct Span {
    double from = 0.0, to = 0.0;
    bool operator==(const Span&) const = default;
};

/// What speaks for a finding.
struct Evidence {
    double reduction = 0.0;        ///< of the criterion (squares in units of the noise, prices) by it alone
    double block_t = 0.0;          ///< mean reduction of a block of the log over its standard error
    double noise_share = 0.0;      ///< rms torque that it alone explains, in units of the noise
    double explained_share = 0.0;  ///< the squares of it, as a share of those of the gap
};

/// Fewer samples do not distinguish noise from torque: the log is refused.
inline constexpr std::size_t fewest_samples_diagnosed = 200;

/// Another effect that explains the log about as well in place of a finding.
struct RivalFinding {
    Term term;            ///< with its values
    double margin = 0.0;  ///< reduction by which the finding is ahead of it
    [[nodiscard]] std::string_view name() const { return term.effect->name; }
};

struct Finding {
    Term term;  ///< with its values
    FindingStatus status = FindingStatus::confirmed;
    std::vector<FittedValue> values;  ///< its fitted parameters
    Evidence evidence;
    std::vector<RivalFinding> alternatives;
    double gap_before_nm = 0.0, gap_after_nm = 0.0;  ///< in the order of the findings
    /// rms residual of the validation log, without it and with it, together with all others.
    std::optional<double> validation_before_nm, validation_after_nm;
    std::string reason;     ///< of a status other than confirmed, a clause
    bool is_given = false;  ///< found beforehand, and part of what is given

    [[nodiscard]] bool is_in_model() const { return !is_given && status <= FindingStatus::correction; }
};

/// A candidate that the search did not add in its last step.
struct RefusedCandidate {
    Term term;  ///< with the values that were tried
    std::string reason;
};

/// Effects between which this log does not decide.
struct Tie {
    std::vector<std::string> effects;
    std::string advice;  ///< the experiment that would
};

/// The variable in which a residual is confined.
enum class RegionKind { throughout, time, speed, position, tone };
[[nodiscard]] std::string_view region_kind_name(RegionKind kind);

/// What the improved model leaves above the noise.
struct RemainingResidual {
    double rms_nm = 0.0;  ///< over the samples used, noise included
    RegionKind kind = RegionKind::throughout;
    Span where;         ///< s, deg/s, deg or Hz
    double part = 1.0;  ///< of what is left
};

/// An effect that is not examined: this log does not let it be, or the gear ratio is not known.
struct Undecidable {
    std::string_view effect;
    std::string reason;
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

/// What the user takes into the model although the log leaves it uncertain.
struct AcceptedFinding {
    Term term;                                      ///< with its values
    FindingStatus status = FindingStatus::refused;  ///< before
    std::string reason;                             ///< against it
};

/// A value of a given term.
struct GivenValue {
    std::string name;  ///< name of the term
    double value = 0.0;
    std::optional<Interval> ci95;
};

/// Of a log whose torque is that of a control law: that torque, and what a residual is as a position.
struct DriveAnswer {
    DrivenTorque torque;
    /// By how much the model's answer to the command is off the log, rms: of the model as given, and of the
    /// improved one.
    double position_before_deg = 0.0, position_after_deg = 0.0;
    /// What each finding of the improved model moves the joint by, rms.
    std::vector<std::pair<std::string, double>> position_of_effects_deg;
};

struct DiagnosisGap {
    double before_nm = 0.0, after_nm = 0.0;  ///< rms of measured less predicted torque, all samples
    double noise_floor_nm = 0.0;             ///< the least that any smooth law leaves
    /// Share of the squared gap above the floor that was closed; empty when there was none.
    std::optional<double> closed_percent;
    std::optional<double> validation_before_nm, validation_after_nm, validation_closed_percent;
};

struct Diagnosis {
    DiagnosisVerdict verdict = DiagnosisVerdict::matches;
    Model baseline;                   ///< the model as given, with the values that were fitted to it alone
    Model model;                      ///< the improved one
    std::vector<FittedValue> values;  ///< of the improved model's own terms, where they were open
    std::vector<Finding> rounds;
    std::vector<RefusedCandidate> refused;
    std::vector<Fault> faults;
    std::vector<std::string> named;
    std::string doubt;  ///< one sentence, where the verdict is undecided
    std::vector<Tie> ambiguous;
    std::vector<Undecidable> undecidable;
    std::optional<RemainingResidual> remaining;  ///< empty: noise
    DiagnosisGap gap;
    std::vector<GivenValue> given;  ///< values of the given terms, in their order
    /// Measured less predicted torque of the model as given and of the improved one, an entry per row.
    std::vector<double> residual_before_nm, residual_after_nm;
    std::vector<double> beside_given_nm;  ///< with known terms: torque less their contribution, as fitted
    std::vector<BandGap> bands;           ///< with known terms
    std::vector<AcceptedFinding> accepted;
    std::vector<std::string> not_accepted;  ///< why a name is not, a sentence each
    std::vector<std::string> next;          ///< what to do where something is uncertain, a sentence each
    /// Faults of the set-up, which call every name into question; the first to repair comes first.
    std::vector<SetupFault> setup;
    /// How far the log is behind the user's simulation, where that is no effect of the joint. The known
    /// torque is shifted by that.
    std::optional<SimulationLag> alignment;
    std::optional<DriveAnswer> drive;  ///< where the torque is that of a control law
    std::size_t samples = 0, samples_used = 0;
    double smoothing_s = 0.0;  ///< window of the motion along which effects were searched
    bool has_position = false;
};

struct DiagnosisOptions {
    Seconds smoothing = default_smoothing;      ///< of the motion along which the gap is measured
    std::span<const std::string> without = {};  ///< names of effects that are not tried
    /// Names of uncertain findings that are taken into the model: a side of a tie, a refused candidate.
    /// Others are listed in Diagnosis::not_accepted.
    std::span<const std::string> accept = {};
    /// Terms that are stated and not searched, a column per value and a row per row of the log; the same of
    /// the validation log, where there is one.
    std::span<const GivenTerm> given = {}, validation_given = {};
    /// Velocities of the arm's joints at the rows of the log, as Motion has them, and of the validation log.
    std::span<const std::vector<double>> others_deg_s = {}, validation_others_deg_s = {};
    /// Ripple that was found in this log beforehand, of which the given term "ripple" is the torque.
    std::span<const Term> found_ripple = {};
    /// The simulation's own motion, an entry per row of the log; empty: not known.
    std::span<const double> simulated_velocity_deg_s = {}, simulated_position_deg = {};
    /// Faults of the set-up that are known beforehand. The known terms are wrong then: nothing is searched.
    std::span<const SetupFault> setup = {};
};

/// Diagnoses a log of at least fewest_samples_diagnosed. `validation` is another log that nothing is
/// fitted to; it may be absent. Throws UsageError: an unknown name in `without`, a model whose lines are not
/// stated; DataError: a log too short, or without motion.
[[nodiscard]] Diagnosis diagnose(const Model& model, const TraceView& log, const TraceView* validation,
                                 const DiagnosisOptions& options = {});

/// What is missing, each with its size and half of its 95 % interval, and the gap: "Missing: coulomb-friction
/// 2.000 +/- 0.010 Nm; residual 1.83 to 0.01 Nm rms, noise 0.02 Nm rms."
[[nodiscard]] std::string diagnosis_sentence(const Diagnosis& diagnosis);
/// A friction below 0 with a simulation in the model: the simulation has too much of it.
[[nodiscard]] bool simulation_exceeds(const Diagnosis& diagnosis, const Finding& finding);

}  // namespace ripplenotch
