// SPDX-License-Identifier: MIT
#pragma once
// A model of a joint is a list of effects with their numbers. It copies, compares and prints; it runs nothing
// itself.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "ripplenotch/model/effect.hpp"

namespace ripplenotch {

/// One effect with one value per parameter. An empty value is one that the model does not state: it is to be
/// fitted to a log, and until then the model cannot be simulated.
struct Term {
    const Effect* effect = nullptr;
    std::vector<std::optional<double>> values;
    bool operator==(const Term&) const = default;
};

/// A sum of joint effects followed by a chain of sensor effects in the order given.
struct Model {
    GearRatio gear_ratio;
    std::vector<Term> terms;
    bool operator==(const Model&) const = default;
};

/// Gear ratios that a model may have: above 0, at most this (no gear comes near it).
inline constexpr GearRatio largest_gear_ratio{1e5};

/// Reads "ripple,order=1,amplitude_nm=0.8,phase_deg=0"; a value may carry any unit of the parameter's
/// dimension
/// ("amplitude_nm=800mNm"). Parameters left out stay to be fitted. Throws UsageError: unknown effect or
/// parameter, value out of its bounds.
[[nodiscard]] Term parse_term(std::string_view spec);

/// Names of the values that the model does not state, as "effects[1].amplitude_nm of ripple".
[[nodiscard]] std::vector<std::string> missing_values(const Model& model);

/// Torque along the motion, in newton-metres, without noise; motion.size() entries. Deterministic to the last
/// bit. Throws UsageError that lists missing_values() when there are any.
[[nodiscard]] std::vector<double> predict_nm(const Model& model, const Motion& motion);

}  // namespace ripplenotch
