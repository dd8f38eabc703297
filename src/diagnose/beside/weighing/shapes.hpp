// SPDX-License-Identifier: MIT
#pragma once
// What may be named beside a leftover: each joint effect of the catalogue, in every shape at which its search
// begins.

#include <optional>
#include <string>
#include <vector>

#include "diagnose/beside/weighing/ground.hpp"
#include "ripplenotch/model/model.hpp"

namespace ripplenotch {

/// Kinds within which one effect can pass for another, or two for two others.
enum class Kind { friction, speed, position, order, time };

/// An effect whose size is 1.
struct Shape {
    Term term;  ///< every value stated; a phase is 0
    /// What the joint's elasticity makes of a part of a ripple: an effect of the ripple's side. The part is
    /// the fit's: four columns for two.
    std::optional<Term> ringing = {};
    bool operator==(const Shape&) const = default;
};

/// A number that a search refines: over which speed, angle or time the effect acts, or where a ripple rings.
struct Scale {
    bool of_ringing = false;
    std::size_t parameter = 0;
};

[[nodiscard]] Kind kind_of(const Effect& effect);
/// True when the effect's torque acts against the motion, so that a size below 0 is another's.
[[nodiscard]] bool is_against_motion(const Effect& effect);
/// Whether the two differ by no more than rounding, as a scale does that went up and down again.
[[nodiscard]] bool alike(const Shape& a, const Shape& b);
/// Whether the two are one name: the same effect, at the same order where it has one.
[[nodiscard]] bool same_name(const Shape& a, const Shape& b);
/// "ripple 2": the name with its order.
[[nodiscard]] std::string shape_name(const Shape& shape);
/// Parameters that say over which speed, angle or time the effect acts.
[[nodiscard]] std::vector<std::size_t> scales_of(const Effect& effect);
/// The term's, then those of what rings.
[[nodiscard]] std::vector<Scale> scales_of(const Shape& shape);
[[nodiscard]] const Parameter& parameter_of(const Shape& shape, const Scale& scale);
[[nodiscard]] double value_of(const Shape& shape, const Scale& scale);
/// The same shape with this number moved.
[[nodiscard]] Shape moved(Shape shape, const Scale& scale, double value);
/// Of a ripple.
[[nodiscard]] double order_of(const Shape& shape);
/// Columns of its torque.
[[nodiscard]] std::size_t columns_of(const Shape& shape);

/// What the log says of the bounds within which scales make sense.
struct ScaleBounds {
    double fastest_deg_s = 0.0, duration_s = 0.0, ratio = 1.0;
    BesideRules rules;

    [[nodiscard]] double low(const Shape& shape, const Scale& scale) const;
    [[nodiscard]] double high(const Shape& shape, const Scale& scale) const;
    [[nodiscard]] double low(const Parameter& scale) const;
    [[nodiscard]] double high(const Parameter& scale) const;
    /// Of a line of this order in the fastest sample.
    [[nodiscard]] double fastest_hz(double order) const { return order * ratio * fastest_deg_s / 360.0; }
    /// True when a scale is so near to its bound that the effect stands in for something else. Widths of a
    /// step may be: logs of steady motion do not tell them.
    [[nodiscard]] bool is_bent(const Shape& shape) const;
    /// The same of what rings.
    [[nodiscard]] bool is_ringing_bent(const Shape& shape) const;
};
/// `ratio`: of the gear.
[[nodiscard]] ScaleBounds scale_bounds(const Case& looked_at, double ratio, const BesideRules& rules);

/// At the orders that the thinned log of this rate resolves.
[[nodiscard]] std::vector<Shape> shapes_of(std::span<const Effect* const> effects, const ScaleBounds& bounds,
                                           double rate_hz);

}  // namespace ripplenotch
