// SPDX-License-Identifier: MIT
#pragma once
// The candidates of the search: effects of the catalogue as columns of torque, as transforms of all columns
// before them, or as another gear ratio. Linear values have a column each; the others are searched.

#include <array>
#include <compare>
#include <cstddef>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "ripplenotch/model/effect.hpp"
#include "ripplenotch/model/model.hpp"

namespace ripplenotch::engine {

class RecordedMotion;

/// Cycles in which what rings falls to 37 %: with fewer, at a damping above a tenth, it is a filter's form.
inline constexpr double fewest_cycles = 1.5;

/// How an effect enters the model.
enum class Role {
    joint_torque,   ///< a column per linear value, through elastic joint and sensor
    sensor_torque,  ///< the same, added behind both: it arises in the sensor
    ripple_change,  ///< ripple columns, each multiplied by the change
    elastic_joint,  ///< a transform of every torque before the sensor
    sensor,         ///< a transform of everything before it
    motor_angle,    ///< another angle of the motor for every ripple: gear ratio, errors of the position
};

/// A value of an effect that is not linear.
struct SearchedValue {
    std::size_t parameter = 0;  ///< place in Effect::parameters
    double lower = 0.0, upper = 0.0;
    std::vector<double> grid;      ///< where the search begins; empty: at places that the log determines
    double step = 0.0;             ///< of the refinement in the value itself; 0: in its logarithm
    double plain = 0.0;            ///< size that is taken where it explains nearly as much; 0: none
    bool is_choice = false;        ///< one of several things: not refined, without a bound or an error
    bool may_be_at_bound = false;  ///< a bound is as good a value as any
};

struct TermKind {
    const Effect* effect = nullptr;
    Role role = Role::joint_torque;
    std::vector<SearchedValue> searched;                  ///< at most most_searched
    std::vector<std::pair<std::size_t, double>> assumed;  ///< other parameters that differ from their start
    bool is_refined = false;                              ///< searched between the grid's values
    bool may_occur_twice = false;
    std::size_t place = 0;  ///< in term_kinds()
};

/// Every kind of candidate, in a fixed order.
[[nodiscard]] std::span<const TermKind> term_kinds();
/// The kind of an effect of that name.
[[nodiscard]] const TermKind& term_kind(std::string_view effect);

/// Values of a term that are searched, at most.
inline constexpr std::size_t most_searched = 3;
/// A kind with its searched values. The gear ratio has the ratio itself as its value.
struct SearchedTerm {
    const TermKind* kind = nullptr;
    std::array<double, most_searched> values{};
    bool operator==(const SearchedTerm&) const = default;
    std::weak_ordering operator<=>(const SearchedTerm& other) const {
        if (const auto order = kind->place <=> other.kind->place; order != 0) return order;
        if (values < other.values) return std::weak_ordering::less;
        return other.values < values ? std::weak_ordering::greater : std::weak_ordering::equivalent;
    }
    [[nodiscard]] bool is(std::string_view effect) const { return kind->effect->name == effect; }
    [[nodiscard]] bool is_transform() const {
        return kind->role == Role::sensor || kind->role == Role::elastic_joint;
    }
    /// Friction that turns over with the direction of the motion.
    [[nodiscard]] bool is_friction_loop() const {
        return is("coulomb-friction") || is("hysteresis") || is("stribeck-friction") || is("backlash");
    }
    [[nodiscard]] bool changes_ripple() const { return kind->role == Role::ripple_change; }
};
using SearchedTerms = std::vector<SearchedTerm>;

[[nodiscard]] bool contains(const SearchedTerms& terms, std::string_view effect);

/// Values of every parameter: searched, assumed, linear ones of 1 (a polar pair of size 1 and phase 0).
[[nodiscard]] std::vector<double> unit_values(const SearchedTerm& term);
/// The torque of an effect of size 1 along a motion, a column per linear value. `values` has one entry per
/// parameter; the linear ones are replaced.
[[nodiscard]] std::vector<std::vector<double>> unit_columns(const Effect& effect, std::vector<double> values,
                                                            const Situation& situation);
/// Factors of the ripple by an effect that changes it, at 100 % and less the unchanged ripple; two for a
/// polar pair.
[[nodiscard]] std::vector<std::vector<double>> ripple_factors(const SearchedTerm& term,
                                                              const Situation& situation);

/// The transforms of a set of terms: first the elastic joint, then the sensor.
struct Transforms {
    SearchedTerms elastic_joint, sensor;
    explicit Transforms(const SearchedTerms& terms);
    [[nodiscard]] SearchedTerms all() const;
};
/// A torque behind these transforms, in their order. One entry per sample of the motion.
[[nodiscard]] std::vector<double> transformed(std::vector<double> torque_nm, const SearchedTerms& transforms,
                                              const Motion& motion);

/// The angle that ripples go with.
struct MotorAngle {
    GearRatio ratio;
    SearchedTerms errors;  ///< of the position
};
/// Of a set of terms, where the user states `known`.
[[nodiscard]] MotorAngle motor_angle(const SearchedTerms& terms, GearRatio known);
/// The motion without errors of its position.
[[nodiscard]] Motion without_errors(const Motion& motion, const SearchedTerms& errors);

/// By which grid and upper bound of a width of friction are wider in this log.
[[nodiscard]] double width_scale(const TermKind& kind, const SearchedValue& value,
                                 const RecordedMotion& recorded);

/// Numbers that a term fits, with so many ripple orders in the model.
[[nodiscard]] std::size_t fitted_values(const SearchedTerm& term, std::size_t ripple_orders);

}  // namespace ripplenotch::engine
