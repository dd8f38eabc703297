// SPDX-License-Identifier: MIT
#pragma once
// Whether a name's size is the same all over the whitened log.

#include "diagnose/beside/weighing/sums.hpp"

namespace ripplenotch {

/// Columns of one name among those of all.
struct OwnColumns {
    Eigen::Index first = 0, count = 0;
};
[[nodiscard]] OwnColumns columns_at(const Sums& sums, const Names& names, std::size_t place);

/// Sizes by parts of the log, each as a multiple of the whole fit's.
struct Sameness {
    double uneven = 0.0;           ///< spread from fold to fold beyond its own noise, of the size
    double same_sign = 0.0;        ///< part of the folds' weight that has the sign of their mean
    double uneven_by_speed = 0.0;  ///< slow and fast, forth, back and at rest; each that tells a size alike
};
[[nodiscard]] Sameness sameness_of(const Sums& sums, const Names& names, std::size_t place);

}  // namespace ripplenotch
