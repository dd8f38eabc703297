// SPDX-License-Identifier: MIT
#pragma once
// The input of a diagnosis from a log: the motion, the torque, which samples count, and the uncertainty of
// the motion itself.

#include <optional>
#include <vector>

#include "core/rows/row_facts.hpp"
#include "diagnose/limits.hpp"
#include "model/fit/weighing.hpp"
#include "ripplenotch/core/trace.hpp"
#include "ripplenotch/diagnose/diagnosis.hpp"
#include "ripplenotch/model/model.hpp"

namespace ripplenotch {

struct Case {
    Motion motion;
    std::vector<double> torque_nm;
    std::vector<unsigned char> use;    ///< 0: this sample does not count
    std::vector<unsigned char> valid;  ///< 0: it holds no torque of the joint; `use` is 0 there
    /// The acceleration less one of three times the smoothing, its noise; and one of half the smoothing less
    /// it, the effect of smoothing on its kinks.
    std::vector<double> rough_deg_s2, blunted_deg_s2;
    /// Columns of the known torque whose factors are not certain, and by how much: an arm's masses.
    std::vector<Nuisance> uncertain;
    std::vector<unsigned char> edge;        ///< 1: so near to a start or stop that noise determines the speed
    std::optional<Seconds> expected_delay;  ///< an additional start of the search for a delay
    double walk_deg =
        0.0;               ///< rms error of the position after 1 s, where it is the integral of a noisy speed
    double step_nm = 0.0;  ///< quantization step of a log whose steps are coarser than its noise
    double moving_deg_s = 0.0;      ///< slower samples count as resting where direction or speed decides
    std::vector<std::size_t> from;  ///< samples at which a stretch begins; the first is 0
    std::vector<std::size_t> row;   ///< row of the log for each sample

    [[nodiscard]] std::size_t size() const { return torque_nm.size(); }
    [[nodiscard]] std::size_t used() const;
};

[[nodiscard]] Case whole_case(const TraceView& log, Seconds smoothing);

/// The case itself up to limits::recording::search_samples; beyond, stretches spread over it that have about
/// as many.
[[nodiscard]] Case excerpt(const Case& whole);

/// Every n-th sample, so that about `count` are left. The sample rate falls with it.
[[nodiscard]] Case sketch(const Case& whole, std::size_t count);
/// The same number in short stretches at the full rate, for effects that depend on neighbouring samples.
[[nodiscard]] Case blocks(const Case& whole, std::size_t count);
/// The same in longer stretches, for effects with a transient response.
[[nodiscard]] Case long_blocks(const Case& whole, std::size_t count);

/// Whether errors of the measured acceleration pass this term with the torque: a sensor, except one by which
/// the torque comes before its motion. In a real arm whose friction seemed to lead its motion such errors
/// masked the friction.
[[nodiscard]] bool carries_errors(const Term& term);

/// Torque errors due to errors of the measured acceleration from smoothing, behind the sensors of the model.
/// The rest of the model is irrelevant.
[[nodiscard]] std::vector<Nuisance> acceleration_errors(const Case& looked_at, const Model& model);
/// The columns of the known torque that are not certain, as the sensors of the model show them.
[[nodiscard]] std::vector<Nuisance> uncertain_torques(const Case& looked_at, const Model& model);
/// Torque errors of a model due to the random-walk error of an integrated position; none where the log has a
/// position.
[[nodiscard]] std::vector<Nuisance> walk_errors(const Case& looked_at, const Model& model);
/// The former, then the latter.
[[nodiscard]] std::vector<Nuisance> motion_errors(const Case& looked_at, const Model& model);

// Faults of the converter, seen in the logged torque itself: no model of the joint is needed for them.
// Samples that they spoiled do not count in anything that follows.

/// Marks spoiled samples in `looked_at.use`.
[[nodiscard]] std::vector<Fault> find_faults(Case& looked_at);

// Where in a log a torque acts.

/// Where `torque_nm`, which `term` adds along the case's motion, has at least half of its largest rms;
/// frequency and order are the term's own.
[[nodiscard]] Place place_of(const Case& looked_at, const std::vector<double>& torque_nm, const Term& term);

// Effects that cannot be examined from a log, because of a missing signal.

struct Effect;

/// True when the effect's torque depends on where the joint is and not only on how it moves. The integral of
/// a velocity determines how far the joint has gone and not from where: a log without position cannot decide
/// such an effect. Ripple is not among them: its phase is that of the motor, and a whole turn of it changes
/// nothing.
[[nodiscard]] bool needs_position(const Effect& effect);

}  // namespace ripplenotch
