// SPDX-License-Identifier: MIT
#pragma once
// A model of a joint is a list of effects with their numbers. It copies, compares and prints; it runs nothing
// itself.

#include <algorithm>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "ripplenotch/core/gear_account.hpp"
#include "ripplenotch/model/effect.hpp"

namespace ripplenotch {

// A part of a model that the user states and that is never searched: the torque of an arm's rigid bodies, or
// the torque of the user's own simulation. Unlike an effect it has columns over the whole log, and values
// that are not queried one by one.

/// Deviation of a value that is stated: so small that nothing moves it.
inline constexpr double stated_deviation = 1e-9;

/// Columns whose values are fitted together with everything else.
struct GivenTerm {
    std::string name;  ///< "arm", "simulated"; "nuisance": fitted with one of them, not reported as a finding
    /// One column a value: the torque in newton-metres that one unit of the value brings, an entry per row of
    /// the log.
    std::vector<std::vector<double>> torque_nm;
    /// Prior of each value: drawn towards `mean` as by a measurement with this standard deviation, in the
    /// value's own unit. A deviation of infinity leaves it free.
    std::vector<double> mean, deviation;
};

/// True when one of these, terms or values of them, has the name.
[[nodiscard]] bool is_given(const auto& given, std::string_view name) {
    return std::ranges::any_of(given, [name](const auto& one) { return one.name == name; });
}

/// One effect with one value per parameter. An empty value is one that the model does not state; what that
/// means is up to the parameter (LeftOut).
struct Term {
    const Effect* effect = nullptr;
    std::vector<std::optional<double>> values;
    bool operator==(const Term&) const = default;
};

/// A value per parameter, as the effect's functions take them: stated, or assumed. Throws
/// std::bad_optional_access where neither is there.
[[nodiscard]] std::vector<double> values_of(const Term& term);

/// The side on which this term acts: its effect's, or the sensor's if Effect::whole applies.
[[nodiscard]] Side side_of(const Term& term);

/// Effects in the order of the document. They act side by side (see Side), not in the order of this list;
/// within one side they do.
struct Model {
    GearRatio gear_ratio;  ///< 0: not known; then no term needs it, see needs_gear_ratio
    std::vector<Term> terms;
    /// A simulation's torque is part of the known torque, and that may hold too much Coulomb, viscous or
    /// quadratic friction: such a term's size is below 0.
    bool beside_simulation = false;
    /// Widest step of a friction at standstill in a fit: a wider one is no step but grows with the speed. 0:
    /// that of the effect.
    double widest_step_deg_s = 0.0;
    [[nodiscard]] bool has_gear_ratio() const { return gear_ratio.value() > 0.0; }
    bool operator==(const Model&) const = default;
};

/// The most that this parameter of an effect may be in a fit of the model.
[[nodiscard]] double max_in(const Model& model, const Effect& effect, std::size_t parameter);
/// The least that this parameter of an effect may be in the model.
[[nodiscard]] double min_in(const Model& model, const Effect& effect, std::size_t parameter);

/// Gear ratios that a model may have: above 0, at most this (no gear comes near it).
inline constexpr GearRatio largest_gear_ratio{1e5};

/// Reads "ripple,order=1,amplitude_nm=0.8,phase_deg=0"; a value may carry any unit of the parameter's
/// dimension ("amplitude_nm=800mNm"). Parameters left out stay to be fitted. Throws UsageError: unknown
/// effect or parameter, value out of its bounds.
[[nodiscard]] Term parse_term(std::string_view spec);

/// Names of the values that the model has to state and does not, as "effects[1].amplitude_nm of ripple".
[[nodiscard]] std::vector<std::string> missing_values(const Model& model);

/// Torque to be expected along the motion, in newton-metres; motion.size() entries. Without noise and without
/// the effects that are chance. Deterministic to the last bit. Throws UsageError that lists missing_values()
/// when there are any.
[[nodiscard]] std::vector<double> predict_nm(const Model& model, const Motion& motion);

/// The response of the model's sensors to a torque in front of them: delays, lags, the joint's spring. A
/// sensor that is not linear is left out, and so are converters.
[[nodiscard]] std::vector<double> sensed_nm(const Model& model, const Motion& motion,
                                            std::vector<double> torque_nm);

/// The gear that the model has: its ratio, and the orders of its ripple terms, each once, lowest first.
/// `source` is who gave the model.
[[nodiscard]] GearAccount gear_of(const Model& model, std::string source);

/// Whether effects that are chance (spikes, dropout) act.
enum class Chance { left_out, acts };

/// Torque as a sensor would log it: `noise_nm` (motion.size() entries, or none) is added after the sensor's
/// effects and before the converter's.
[[nodiscard]] std::vector<double> measure_nm(const Model& model, const Motion& motion,
                                             std::span<const double> noise_nm, Chance chance = Chance::acts);

}  // namespace ripplenotch
