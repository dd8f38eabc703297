// SPDX-License-Identifier: MIT
#pragma once
// Where the ripple of a joint is, and who says so.

#include <string>
#include <vector>

#include "ripplenotch/core/quantity.hpp"

namespace ripplenotch {

struct GearAccount {
    GearRatio ratio;            ///< 0: not known
    std::vector<Order> orders;  ///< lowest first, each once; empty where other lines alone are asked for
    std::vector<double> amplitude_nm;  ///< one per order where all are known, else empty
    std::vector<double> phase_deg;     ///< the same; of cos(order * motor angle + phase)
    std::string source;                ///< "--gear-ratio, orders by default", "joint.json"
};

/// Orders of a gear whose ratio is known and whose orders nobody states: the motor turn and the two lobes of
/// the wave generator (Kim, Kim, Song 2011).
[[nodiscard]] inline std::vector<Order> default_orders() { return {Order(1.0), Order(2.0)}; }

}  // namespace ripplenotch
