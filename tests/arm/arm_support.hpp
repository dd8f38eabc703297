// SPDX-License-Identifier: MIT
#pragma once
// Arms and motions for tests.

#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "ripplenotch/arm/arm_fit.hpp"
#include "ripplenotch/arm/chain.hpp"

namespace ripplenotch::test {

inline constexpr double radians = std::numbers::pi / 180.0;

/// Craig's parameters of the Panda as its maker publishes them (Franka Control Interface documentation, robot
/// and interface specifications).
inline const std::string panda_mdh =
    "a_m,alpha_deg,d_m,theta_deg\n0,0,0.333,0\n0,-90,0,0\n0,90,0.316,0\n0.0825,90,0,0\n-0.0825,-90,0.384,0\n"
    "0,90,0,0\n0.088,90,0,0\n";

/// Six joints with the lengths of a small industrial arm.
inline const std::string six_dh =
    "a_m,alpha_deg,d_m,theta_deg\n0,90,0.13,0\n-0.6,0,0,0\n-0.55,0,0,0\n0,90,0.16,0\n0,-90,0.11,0\n0,0,0.09,"
    "0\n";

/// Smooth motions of `n` joints, each a sum of five sines as for identification (Swevers 1997).
inline std::vector<Motion> fourier_motions(std::size_t n, double seconds, double rate_hz, unsigned seed,
                                           double size_deg = 40.0) {
    std::mt19937_64 random(seed);
    const auto uniform = [&] { return 0x1p-52 * static_cast<double>(random() >> 11) - 1.0; };
    const auto samples = static_cast<std::size_t>(seconds * rate_hz);
    std::vector<Motion> motions(n);
    for (Motion& motion : motions) {
        motion.sample_rate = Hertz(rate_hz);
        for (auto* values :
             {&motion.time_s, &motion.position_deg, &motion.velocity_deg_s, &motion.acceleration_deg_s2})
            values->assign(samples, 0.0);
        for (std::size_t k = 0; k < samples; ++k) motion.time_s[k] = static_cast<double>(k) / rate_hz;
        const double offset_deg = 60.0 * uniform();
        for (int line = 1; line <= 5; ++line) {
            const double w = 2.0 * std::numbers::pi * 0.1 * (line + 0.3 * uniform());
            const double size = size_deg * uniform() / std::sqrt(line), phase = 3.0 * uniform();
            for (std::size_t k = 0; k < samples; ++k) {
                const double angle = w * motion.time_s[k] + phase;
                motion.position_deg[k] += size * std::sin(angle) + offset_deg / 5.0;
                motion.velocity_deg_s[k] += size * w * std::cos(angle);
                motion.acceleration_deg_s2[k] -= size * w * w * std::sin(angle);
            }
        }
    }
    return motions;
}

/// Links that could be: ten values each, of a body with its centre within 0.2 m of the frame.
inline std::vector<double> random_links(std::size_t n, unsigned seed) {
    std::mt19937_64 random(seed);
    const auto uniform = [&] { return 0x1p-52 * static_cast<double>(random() >> 11) - 1.0; };
    std::vector<double> values;
    for (std::size_t link = 0; link < n; ++link) {
        const double m = 3.0 + 2.0 * uniform(), x = 0.2 * uniform(), y = 0.2 * uniform(), z = 0.2 * uniform();
        const double own = 0.02 * (2.0 + uniform());
        for (const double value :
             {m, m * x, m * y, m * z, own + m * (y * y + z * z), -m * x * y, -m * x * z,
              1.2 * own + m * (x * x + z * z), -m * y * z, 0.9 * own + m * (x * x + y * y)})
            values.push_back(value);
    }
    return values;
}

}  // namespace ripplenotch::test
