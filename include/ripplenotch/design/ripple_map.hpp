// SPDX-License-Identifier: MIT
#pragma once
// A ripple map: a joint's ripple at every angle of its motor, speed and direction. A compensator subtracts
// it; drives store it. Made from logs by filter/map_fit.hpp.

#include <complex>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "ripplenotch/core/quantity.hpp"

namespace ripplenotch {

/// The variables of a map's amplitudes. A wave generator turns gear ratio times in an output turn
/// against one spline and once more or less against the other: an order n of the map has lines at n Kg and,
/// with a second comb, at n (Kg +/- 1). Each direction has its own columns, in this order: the amplitude at
/// each speed (linear between them), then the same of the second comb.
struct MapForm {
    /// Values of |v|, rising; a single one: the same at every speed.
    std::vector<double> speeds_deg_s = {0.0};
    std::size_t directions = 1;  ///< 2: forward (v > 0) and backward have their own amplitudes
    int second_comb = 0;         ///< 0: none; 1 or -1: at n (Kg + 1) or at n (Kg - 1)

    [[nodiscard]] std::size_t columns_a_direction() const {
        return speeds_deg_s.size() * (second_comb == 0 ? 1 : 2);
    }
    [[nodiscard]] bool is_second_comb(std::size_t column) const {
        return column % columns_a_direction() >= speeds_deg_s.size();
    }
    [[nodiscard]] std::size_t columns() const { return directions * columns_a_direction(); }
};

/// From the least to the greatest that the logs hold.
struct MapRange {
    double from = 0.0, to = 0.0;
    [[nodiscard]] double middle() const { return 0.5 * (from + to); }
};

/// Where a joint is.
struct MapState {
    double speed_deg_s = 0.0;   ///< signed
    double position_deg = 0.0;  ///< position of the joint, as in the log
};

/// The ripple is the sum over the orders of Re(z exp(-i n theta)) = Re(z) cos(n theta) + Im(z) sin(n theta),
/// theta being gear ratio times (position - zero), and z the sum of the form's columns times `values`, those
/// of a second comb s turned by exp(-i s n (position - zero)).
struct RippleMap {
    std::string joint;          ///< empty for a joint without a name
    GearRatio gear_ratio;       ///< no_ratio (gear_account.hpp): the orders count by turns of the joint
    std::vector<Order> orders;  ///< lowest first; empty: nothing turns with the motor
    MapForm form;
    double zero_deg = 0.0;                 ///< joint position at which the motor's angle is 0
    MapRange speeds_deg_s, positions_deg;  ///< seen by the logs; speeds are held at the edges beyond
    std::vector<std::vector<std::complex<double>>> values;  ///< by order, then by column; Nm
    std::vector<double> spread_nm;  ///< by order: rms deviation of amplitudes from the map in its logs
    /// Ripple of the motors of other joints in this joint's torque: each goes by the angle and speed of
    /// `joint`.
    std::vector<RippleMap> others;
};

/// The weight of each column at this state. Beyond the range of the map its edge counts; slower than the
/// slowest speed seen, the two directions are blended, half and half at standstill.
/// weights.size() = map.form.columns().
void map_weights(const RippleMap& map, const MapState& state, std::span<double> weights);

/// By which the second comb's columns of an order are turned at a joint position; 1 without a second comb.
[[nodiscard]] std::complex<double> second_comb_phasor(const RippleMap& map, std::size_t order,
                                                      double position_deg);

/// The amplitude of one order under these weights at a joint position: its cosine and sine part.
[[nodiscard]] std::complex<double> map_amplitude(const RippleMap& map, std::size_t order,
                                                 std::span<const double> weights, double position_deg);

/// The ripple at this state, Nm.
[[nodiscard]] double map_torque(const RippleMap& map, const MapState& state);

/// The same ripple with angles counted from another position of the joint.
[[nodiscard]] RippleMap with_zero(const RippleMap& map, double zero_deg);

}  // namespace ripplenotch
