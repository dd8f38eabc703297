// SPDX-License-Identifier: MIT
#pragma once
// What may be named beside a leftover: each joint effect of the catalogue, in every shape at which its search
// begins.

#include <string>
#include <vector>

#include "diagnose/beside/ground.hpp"
#include "ripplenotch/model/model.hpp"

namespace ripplenotch {

/// Kinds within which one effect can pass for another, or two for two others.
enum class Kind { friction, speed, position, order, time };

/// An effect whose size is 1.
struct Shape {
    Term term;  ///< every value stated; a phase is 0
    /// Ripple whose size and phase go with speed and direction: eight columns for two.
    bool swelling = false;
    bool operator==(const Shape&) const = default;
};

[[nodiscard]] Kind kind_of(const Effect& effect);
/// True when the effect's torque acts against the motion, so that a size below 0 is another's.
[[nodiscard]] bool is_against_motion(const Effect& effect);
/// Whether the two are one name: the same effect, at the same order where it has one.
[[nodiscard]] bool same_name(const Shape& a, const Shape& b);
/// "ripple 2": the name with its order.
[[nodiscard]] std::string shape_name(const Shape& shape);
/// Parameters that say over which speed, angle or time the effect acts; a search refines them.
[[nodiscard]] std::vector<std::size_t> scales_of(const Effect& effect);
/// Columns of its torque.
[[nodiscard]] std::size_t columns_of(const Shape& shape);

/// What the log says of the bounds within which scales make sense.
struct ScaleBounds {
    double fastest_deg_s = 0.0, duration_s = 0.0;
    BesideRules rules;

    [[nodiscard]] double low(const Parameter& scale) const;
    [[nodiscard]] double high(const Parameter& scale) const;
    /// True when a scale is so near to its bound that the effect stands in for something else. Widths of a
    /// step may be: logs of steady motion do not tell them.
    [[nodiscard]] bool is_bent(const Shape& shape) const;
};
[[nodiscard]] ScaleBounds scale_bounds(const Case& looked_at, const BesideRules& rules);

/// `ratio`: of the gear, for the orders that the thinned log of this rate resolves.
[[nodiscard]] std::vector<Shape> shapes_of(std::span<const Effect* const> effects, const ScaleBounds& bounds,
                                           double ratio, double rate_hz);

}  // namespace ripplenotch
