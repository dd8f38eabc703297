// SPDX-License-Identifier: MIT
#pragma once
// Whether a fitted shape is the effect's own.

#include <string_view>

#include "diagnose/search/model_bench.hpp"

namespace ripplenotch {

// At which speed a ripple that swells has the amplitude of its term. A ripple that is nothing at rest has no
// amplitude there, and a gain on nothing is a number that no log tells: it is stated from a speed of the log.

/// The speed of the log from which such a ripple is stated: the rms of those at which the joint moves, in two
/// digits. 0 where it rests.
[[nodiscard]] double usual_speed_deg_s(const Case& looked_at);

/// States each change of the ripple that was found (it has a price) from rest, or from the usual speed where
/// less of the ripple than search.least_at_rest is there at rest. Terms whose ripple is not all fitted stay
/// as they are. The torque stays the same.
void state_where_told(Candidate& model, const Case& looked_at, const DiagnosisRules& rules);

/// How a shape is bent.
struct Bend {
    std::string_view parameter;  ///< empty: it is not
    std::string_view rule;       ///< that says so
    double number = 0.0;         ///< what it was asked about
};

/// The first parameter of a term that is bent as far as its bounds allow, or so far that the torque is as
/// good as at a bound. Such an effect has lost what tells it from others: Stribeck friction of a Stribeck
/// speed far above all speeds is Coulomb friction. A bound at which the effect is what it is at its neutral
/// value, and one that the log hardly tells from a value within, bend nothing.
[[nodiscard]] Bend bend_of(const ModelBench& bench, const Candidate& model, std::size_t term);

}  // namespace ripplenotch
