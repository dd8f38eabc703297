// SPDX-License-Identifier: MIT
#pragma once
// Where in frequency the torque of a log is, and where it is no more.

#include <span>
#include <vector>

#include "ripplenotch/core/quantity.hpp"
#include "ripplenotch/diagnose/diagnosis.hpp"

namespace ripplenotch {

/// Below 1 Hz, from 1 to 10 Hz, and above; an entry per row of the log in each list. A mean counts below
/// 1 Hz, but for that of the torque.
[[nodiscard]] std::vector<BandGap> band_gaps(std::span<const double> torque_nm,
                                             std::span<const double> beside_given_nm,
                                             std::span<const double> after_nm, Hertz sample_rate);

}  // namespace ripplenotch
