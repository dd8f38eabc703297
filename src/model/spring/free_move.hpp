// SPDX-License-Identifier: MIT
#pragma once
// How a mass on a damped spring moves when nothing drives it.

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

namespace ripplenotch {

/// What becomes within a step of a free mass's displacement, and of its speed in displacements a radian of
/// the undamped spring.
struct FreeMove {
    double at_of_at, at_of_moving, moving_of_moving;  ///< and -at_of_moving from at to moving
};

/// Within so many radians of the undamped spring.
[[nodiscard]] FreeMove free_move(double damping, double radians);

/// Free moves over steps of many lengths, as an uneven clock has them: each from one that is near and known
/// already, and the first terms of its series for what is left.
class FreeMoves {
  public:
    explicit FreeMoves(double damping);

    /// As free_move, to rounding.
    [[nodiscard]] FreeMove within(double radians);

  private:
    static constexpr std::size_t terms = 6;    // by spacing (free_move.cpp): what is left out is rounding
    using Series = std::array<double, terms>;  ///< by power of the radians
    [[nodiscard]] FreeMove shortly(double radians) const;

    double damping_;
    Series at_of_at_, at_of_moving_;
    std::vector<std::optional<FreeMove>> known_;  ///< by place
};

}  // namespace ripplenotch
