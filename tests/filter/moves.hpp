// SPDX-License-Identifier: MIT
#pragma once
// Motions whose true torque is known, for measuring what methods leave of the error.

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "filter/tables.hpp"
#include "ripplenotch/model/model.hpp"
#include "ripplenotch/model/motion.hpp"
#include "ripplenotch/model/noise.hpp"

namespace ripplenotch::testing {

/// Signals with the torque that a perfect sensor would have given.
struct KnownMove {
    Signals signals;
    std::vector<double> true_nm;
};

/// The paper's move, 90 to -90 deg in 2 s, gear ratio 100, 1 kHz: inertial torque of 4.5 Nm at most, ripple
/// of 0.8 Nm (order 1) and 0.5 Nm (order 2), noise of 0.05 Nm rms. The phases, of cosines in the motor angle,
/// decide how much ripple stands still with the joint at both ends, where no causal method can tell it from
/// torque.
inline KnownMove paper_move(std::uint64_t seed, double phase1_deg = 90.0, double phase2_deg = 90.0,
                            double noise_nm = 0.05) {
    const double phase1 = phase1_deg * std::numbers::pi / 180.0,
                 phase2 = phase2_deg * std::numbers::pi / 180.0;
    const Motion motion = make_motion("poly6,from=90deg,to=-90deg,duration=2s", Hertz(1000.0));
    double peak = 0.0;
    for (const double a : motion.acceleration_deg_s2) peak = std::max(peak, std::abs(a));
    KnownMove move;
    move.signals.velocity_deg_s = motion.velocity_deg_s;
    move.signals.position_deg = motion.position_deg;
    for (std::size_t k = 0; k < motion.position_deg.size(); ++k) {
        const double theta = 100.0 * motion.position_deg[k] * std::numbers::pi / 180.0;
        move.true_nm.push_back(4.5 * motion.acceleration_deg_s2[k] / peak);
        move.signals.torque_nm.push_back(move.true_nm.back() + 0.8 * std::cos(theta + phase1) +
                                         0.5 * std::cos(2.0 * theta + phase2));
    }
    add_white_noise(move.signals.torque_nm, noise_nm, seed, NoiseChannel::torque);
    return move;
}

/// Position from the velocity alone, with noise on it; the first position is right.
inline void integrate_noisy_velocity(KnownMove& move, double noise_deg_s, double offset_deg_s,
                                     std::uint64_t seed) {
    Signals& s = move.signals;
    add_white_noise(s.velocity_deg_s, noise_deg_s, seed, NoiseChannel::velocity);
    for (double& v : s.velocity_deg_s) v += offset_deg_s;
    for (std::size_t k = 1; k < s.position_deg.size(); ++k)
        s.position_deg[k] = s.position_deg[k - 1] + 0.0005 * (s.velocity_deg_s[k - 1] + s.velocity_deg_s[k]);
}

inline double rms_error(const std::vector<double>& out, const std::vector<double>& truth,
                        std::size_t from = 0, std::size_t to = static_cast<std::size_t>(-1)) {
    double sum = 0.0;
    to = std::min(to, out.size());
    for (std::size_t k = from; k < to; ++k) sum += std::pow(out[k] - truth[k], 2);
    return std::sqrt(sum / static_cast<double>(to - from));
}

}  // namespace ripplenotch::testing
