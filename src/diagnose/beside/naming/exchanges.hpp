// SPDX-License-Identifier: MIT
#pragma once
// What makes a set of names fit better out of fold without adding one: other shapes, another name in the
// place of one, two others in the place of two.

#include <vector>

#include "diagnose/beside/weighing/sums.hpp"

namespace ripplenotch {

/// Names in hand, and how well they fit.
struct Named {
    Names names;
    double left = 0.0;  ///< Sums::left_outside
};

/// Shapes that must not come: withdrawn before.
using Barred = std::vector<Shape>;

[[nodiscard]] bool is_among(const Sums& sums, const Names& names, const Shape& shape);
[[nodiscard]] bool is_barred(const Barred& barred, const Shape& shape);

/// Each scale moved by ever smaller factors as long as that helps.
[[nodiscard]] Named refined(Sums& sums, Named now);
/// Single exchanges until none helps.
[[nodiscard]] Named with_better_names(Sums& sums, Named now, const Barred& barred);
/// The best exchange of two names of the friction and speed kinds for two others: step by step a mixture of
/// two passes for a third.
[[nodiscard]] Named with_better_pair(Sums& sums, Named now, const Barred& barred);

}  // namespace ripplenotch
