// SPDX-License-Identifier: MIT
#pragma once
// Friction from a table of constant speeds and the torque that each took, in place of a log.

#include <cstddef>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "ripplenotch/diagnose/diagnosis.hpp"
#include "ripplenotch/model/fit.hpp"
#include "ripplenotch/model/model.hpp"

namespace ripplenotch {

/// A row per measured speed, in any order; both spans have as many.
struct FrictionTable {
    std::span<const double> velocity_deg_s, torque_nm;
};

/// An effect that was tried beside Coulomb and viscous friction.
struct TriedFriction {
    std::string_view effect;
    bool found = false;
    double chance = 0.0;  ///< that a table without it lowers the residual as much, given all that was tried
};

struct FrictionDiagnosis {
    Model model;  ///< Coulomb and viscous friction, then what was found; without gear ratio
    std::vector<FittedValue> values;  ///< every fitted value, with its 95 % interval
    std::vector<TriedFriction> tried;
    std::vector<Tie> ambiguous;
    std::vector<Undecidable> undecidable;
    double residual_nm = 0.0;      ///< rms of what the model leaves
    double noise_nm = 0.0;         ///< standard deviation of a row's torque, from the residual
    std::size_t rows = 0;          ///< that were used: those that move
    std::size_t rows_at_rest = 0;  ///< not used: friction at standstill takes any value up to the breakaway
    std::size_t positive = 0, negative = 0;  ///< rows used, by direction
    Span speed_deg_s;                        ///< slowest and fastest of them
    /// Stribeck speeds at which a Stribeck friction as large as the Coulomb friction would have been found.
    std::optional<Span> stribeck_deg_s;
};

/// Fits the frictions of the catalogue. Intervals are of the residual sum of squares along each value, with
/// Student's t for the degrees of freedom. Throws UsageError for spans of different lengths, DataError for a
/// table of too few rows or of one speed, or whose torque is against the motion.
[[nodiscard]] FrictionDiagnosis diagnose_friction(const FrictionTable& table);

}  // namespace ripplenotch
