// SPDX-License-Identifier: MIT
#pragma once
// Lines of a residual: in time, where they are tones, and over the output angle, where they are orders.

#include <cstddef>
#include <span>
#include <vector>

#include "diagnose/case/case.hpp"
#include "diagnose/limits.hpp"
#include "ripplenotch/core/quantity.hpp"
#include "ripplenotch/diagnose/diagnosis.hpp"

namespace ripplenotch {

// The spectrum used to search for lines of a residual: of samples at any positions, in time or in angle.

/// Values in Nm at places in s or in deg.
struct LineSamples {
    std::vector<double> where, value;
};

/// From the first place to the last one; never 0.
[[nodiscard]] double range_of(const LineSamples& samples);

// Where in frequency the torque of a log is, and where it is no more.

/// Below 1 Hz, from 1 to 10 Hz, and above; an entry per row of the log in each list. A mean counts below
/// 1 Hz, but for that of the torque.
[[nodiscard]] std::vector<BandGap> band_gaps(std::span<const double> torque_nm,
                                             std::span<const double> beside_given_nm,
                                             std::span<const double> after_nm, Hertz sample_rate);

struct ResidualLine {
    bool by_angle = false;
    double frequency = 0.0;     ///< Hz, or cycles per degree of output
    double amplitude_nm = 0.0;  ///< zero to peak
    double prominence = 0.0;    ///< power over the median power about it
};

/// The strongest lines whose prominence is at least `least`, the strongest first, at most `most`.
[[nodiscard]] std::vector<ResidualLine> standing_out(const Case& looked_at,
                                                     const std::vector<double>& residual_nm, double least,
                                                     std::size_t most);

/// Frequencies of the strongest tones of the residual, refined: at most limits::screening::most_tones.
[[nodiscard]] std::vector<double> strongest_tones_hz(const Case& looked_at,
                                                     const std::vector<double>& residual_nm);

/// The orders of a model's ripple, and the gear ratio with what its terms make of it.
struct StatedRipple {
    std::vector<double> orders;
    GearRatio ratio;
};
[[nodiscard]] StatedRipple stated_ripple(const Model& model);

/// Gear ratios that put `orders` on the strongest lines of a torque over the angle, the best first; how many
/// were compared comes with them. At most limits::screening::most_ratios.
/// Gear ratios that are compared.
struct RatioRange {
    double lowest, highest;
};

struct RatioCandidates {
    std::vector<double> ratios;
    double compared = 1.0;
    double strongest_nm2 = 0.0;  ///< squared amplitudes that the orders have at the best one, in all
};
[[nodiscard]] RatioCandidates likely_ratios(const Case& looked_at, const std::vector<double>& torque_nm,
                                            const std::vector<double>& orders, RatioRange range);

}  // namespace ripplenotch
