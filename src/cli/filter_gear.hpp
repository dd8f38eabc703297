// SPDX-License-Identifier: MIT
#pragma once
// Whose ripple a filtered log is measured for.

#include <optional>
#include <string>
#include <vector>

#include "cli/chosen_method.hpp"
#include "ripplenotch/analysis/ripple_meter.hpp"

namespace ripplenotch {

struct Gear {
    std::optional<GearRatio> ratio;
    std::vector<Order> orders;
    std::vector<double> amplitude_nm;  ///< stated by the table or the joint, one per order; else empty
};

/// Stated options first, then the method's own keys, the joint file, the method's table.
[[nodiscard]] Gear gear_of(const std::optional<std::string>& joint_file, std::optional<double> gear_ratio,
                           const std::vector<double>& orders, const ChosenMethod& method);

/// The complex gains of the method's filter for the gear's lines, by speed; for a RippleMeter. The gear has a
/// ratio.
[[nodiscard]] LineGains gains_of(const ChosenMethod& method, const Gear& gear, Hertz sample_rate);

/// Whether what is left of the ripple is predicted along a log: not for methods that look at the whole log
/// first, and not for `oscillator`.
[[nodiscard]] bool predictable(const ChosenMethod& method);

}  // namespace ripplenotch
