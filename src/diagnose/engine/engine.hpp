// SPDX-License-Identifier: MIT
#pragma once
// Which effects of the catalogue a model or a simulation of a joint lacks, from one log: the entry point.

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "diagnose/engine/recorded_motion.hpp"
#include "diagnose/engine/search.hpp"
#include "ripplenotch/model/fit.hpp"
#include "ripplenotch/model/model.hpp"

namespace ripplenotch::engine {

struct Input {
    TraceView log;
    /// Gear ratio and ripple of the joint; without a simulation also the terms that the user knows. Inertia
    /// is always fitted.
    const Model& model;
    /// The user's own simulation, along its own motion.
    std::optional<Simulation> simulation = {};
    /// Known torque with priors, a column per value and an entry per row of the log: an arm's rigid bodies.
    std::span<const GivenTerm> given_terms = {};
    /// Velocities of the arm's joints, an entry per row of the log: see Motion.
    std::span<const std::vector<double>> others_deg_s = {};
    std::span<const std::string> without = {};  ///< names of effects that are not tried
    /// Of each row: 0 where it does not hold the joint's torque; empty: all do.
    std::span<const unsigned char> is_good_row = {};
};

/// A term that explains the log about as well in place of an adopted one.
struct Rival {
    Term term;
    double margin = 0.0;  ///< of the criterion, by which the adopted term is ahead
};

struct AdoptedTerm {
    Term term;  ///< with its values
    std::vector<FittedValue>
        values;                    ///< its fitted values, with 95 % intervals; `term` is the place in terms
    double reduction = 0.0;        ///< of the criterion, by this term alone
    double block_t = 0.0;          ///< mean reduction of a block over its standard error
    double noise_share = 0.0;      ///< rms torque that only this term explains, in units of the noise
    double explained_share = 0.0;  ///< part of the squares of the first residual that only it explains
    std::vector<Rival> rivals;     ///< with less than `least_reduction` between them, nearest first
};

struct NearlyAdopted {
    Term term;
    std::string reason;  ///< why not, a clause
};

struct Result {
    std::vector<AdoptedTerm> terms;  ///< missing effects, in order of adoption
    std::vector<AdoptedTerm>
        corrections;  ///< below what the log resolves: fitted and not reported as missing
    std::vector<NearlyAdopted> nearly_adopted;
    std::vector<ValuedColumn> baseline;  ///< what the columns of the user's side come to
    /// Their factors with the first so many of `terms` and then `corrections`, from none to all.
    std::vector<std::vector<double>> baseline_factors;
    std::vector<std::size_t> spike_rows;  ///< of the log; empty where nothing stands alone
    double rms_before_nm = 0.0, rms_after_nm = 0.0;
    double noise_nm = 0.0;                         ///< the least that any smooth law leaves
    double simulated_inertia_nm_per_deg_s2 = 0.0;  ///< 0 without a simulation
    /// Residual of the improved model, an entry per row of the log; 0 where the row does not count.
    std::vector<double> residual_after_nm;
    std::vector<unsigned char> is_used;  ///< of each row: it counts
    std::size_t samples = 0;             ///< that count
    double smoothing_s = 0.0;            ///< window of the motion
};

/// Throws DataError for a log that is too short or does not move.
[[nodiscard]] Result find_missing_effects(const Input& input);

}  // namespace ripplenotch::engine
