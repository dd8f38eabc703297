// SPDX-License-Identifier: MIT
#pragma once
// Where the search for an effect may begin: the values from the catalogue, and those that the residual itself
// shows.

#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "diagnose/case/case.hpp"
#include "diagnose/case/lines.hpp"
#include "diagnose/limits.hpp"
#include "diagnose/search/model_bench.hpp"

namespace ripplenotch {

// Whether a fitted shape is the effect's own.

// The speed at which a ripple that grows with speed has the amplitude of its term. A ripple that is zero at
// standstill has no amplitude there, and a factor on zero is not identifiable: it is stated from a speed of
// the log.

/// The speed of the log from which such a ripple is stated: the rms of those at which the joint moves, in two
/// digits. 0 without motion.
[[nodiscard]] double usual_speed_deg_s(const Case& looked_at);

/// States each change of the ripple that was found (it has a price) from standstill, or from the usual speed
/// where less of the ripple than search.least_at_rest is present at standstill. Terms whose ripple is not all
/// fitted stay as they are. The torque stays the same.
void state_where_told(Candidate& model, const Case& looked_at);

/// The first parameter of a term that is bent as far as its bounds allow, or so far that the torque is as
/// good as at a bound. Such an effect can no longer be distinguished from others: Stribeck friction of a
/// Stribeck speed far above all speeds is Coulomb friction. A bound at which the effect is the same as at its
/// neutral value, and one that the log hardly distinguishes from a value within, bend nothing. Empty: none is
/// bent.
[[nodiscard]] std::string_view bent_parameter(const ModelBench& bench, const Candidate& model,
                                              std::size_t term);

// When inertia and gravity change within a log: where the search for a payload that is picked up or put down
// begins.

struct ChangeTimes {
    std::vector<double> times_s;  ///< from the first sample, the likeliest first; none in a short log
    double compared = 1.0;        ///< number of times that were compared
};

/// The times at which a change of inertia and gravity reduces the sum of squares of the residual most, each
/// by least squares together with a constant inertia, gravity and offset.
[[nodiscard]] ChangeTimes change_times(const Case& looked_at, const std::vector<double>& residual_nm,
                                       double noise_nm);

/// Results from the whole residual: lines finer than a thinned log resolves.
struct Hints {
    std::vector<double> tones_hz, orders;
    GearRatio ratio;
    RatioCandidates ratios;
    std::optional<double> delay_s = {};
    ChangeTimes changes;
    double least_order = 0.0;  ///< for orders in position and direction: fewer cycles per turn are ignored
};

/// Gear ratios that are compared for a model whose ratio is `about`. An order that the search chose from its
/// list determines nothing: a ratio that brings it nearer to another one of the list is that order of the
/// same gear.
[[nodiscard]] RatioRange ratios_beside(const Candidate& model, double about);

[[nodiscard]] Hints hints_of(const ModelBench& bench, const Candidate& model,
                             const std::vector<double>& left_nm);

/// The effect with every combination of the values at which its search may begin. `samples`: of the log.
/// `cells` is multiplied by the number of places that were compared to choose them.
[[nodiscard]] std::vector<Term> starts_of(const Effect& effect, const Hints& hints, double samples,
                                          double& cells);

/// A joint has one delay, one lag, one gear ratio, ripple grows with the speed in one way, and friction of
/// one form has one size: a second one would only correct the first for another effect. `open`: values to be
/// fitted are empty.
[[nodiscard]] bool is_there_already(const Term& tried, const Model& open);

// A gear ratio that is wrong and a delayed torque mask each other: without the delay no ratio puts the ripple
// on a line, and without the ratio no delay does. They are searched for together.

/// The case for a torque delayed by `late`: each sample with the position of that much earlier. Samples whose
/// earlier position is not in the same stretch do not count.
[[nodiscard]] Case seen_late(const Case& looked_at, Seconds late);

/// The model with a delay and a gear ratio that together raise the ripple's lines above those of the best
/// ratio alone by a factor of limits::screening::late_ratio; fitted. One of the two that the search has added
/// is replaced by the pair. None where the first `own_terms` terms hold one, where the model has both, where
/// they are not among `effects`, or where no delay makes that much.
[[nodiscard]] std::optional<Candidate> with_late_ratio(const ModelBench& bench, const Candidate& now,
                                                       std::size_t own_terms,
                                                       std::span<const Effect* const> effects);

}  // namespace ripplenotch
