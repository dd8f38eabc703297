// SPDX-License-Identifier: MIT
#pragma once
// What the sensor does to all of the torque, sought where a part of it is given: a delay or a lag turns what
// is given as well, and no name makes up for that.

#include <optional>
#include <vector>

#include "diagnose/beside/finding/beside.hpp"
#include "diagnose/beside/weighing/sums.hpp"

namespace ripplenotch {

/// A log with what is given of it and the names that were found, without anything of the sensor.
struct Unsensed {
    std::span<const GivenTerm> given;
    const Candidate& model;
    const Sums& sums;
    const Names& names;
};

/// The delay or lag to look at, tuned: of the whole samples by which the torque may be late or early, those
/// that leave least out of fold, where that is worth the price of `effects` names. Nothing where an end of
/// the range is best.
[[nodiscard]] std::optional<Term> suspected_sensor(const Unsensed& plain,
                                                   std::span<const Effect* const> examined,
                                                   std::size_t effects);

/// The model with the term.
[[nodiscard]] Candidate with_sensor(const Candidate& model, const Term& sensor);

/// What is left of the log with this sensor is in `sums`, by `names` of its own.
struct SensedLook {
    const Term& sensor;
    const Sums& sums;
    const Names& names;
};

struct SensorVerdict {
    Finding finding;
    std::optional<Term> ahead;  ///< another that explains the log clearly better
};
/// Whether it holds: worth its price beside the best names without it, alike in each fold, told from its
/// rival.
[[nodiscard]] SensorVerdict judged_sensor(const Unsensed& plain, const SensedLook& behind,
                                          std::span<const Effect* const> examined, std::size_t effects);

}  // namespace ripplenotch
