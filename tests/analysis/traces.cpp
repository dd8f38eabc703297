// SPDX-License-Identifier: MIT
#include "analysis/traces.hpp"

#include <algorithm>

template class std::mersenne_twister_engine<std::uint_fast32_t, 32, 624, 397, 31, 0x9908b0df, 11, 0xffffffff,
                                            7, 0x9d2c5680, 15, 0xefc60000, 18, 1812433253>;

namespace ripplenotch::tests {

double Noise::operator()() {
    double sum = -6.0;
    for (int i = 0; i < 12; ++i) sum += static_cast<double>(engine_()) / 4294967296.0;
    return sum;
}

Trace make_trace(const TraceRecipe& recipe) {
    Trace trace;
    trace.sample_rate = Hertz(recipe.rate_hz);
    Noise noise(recipe.seed), jitter(recipe.seed + 7919);
    const double dt = 1.0 / recipe.rate_hz;
    const auto n = static_cast<std::size_t>(std::llround(recipe.seconds * recipe.rate_hz));
    double angle = 0.0, last = 0.0;
    for (std::size_t k = 0; k < n; ++k) {
        double t = static_cast<double>(k) * dt;
        if (recipe.jitter_steps > 0.0)
            t += std::min(std::max(recipe.jitter_steps * jitter(), -0.45), 0.45) * dt;
        // Eight Simpson steps a sample: the angle is that of the motion, not of its samples.
        const double h = (t - last) / 8.0;
        for (int i = 0; i < 8 && k > 0; ++i) {
            const double a = last + h * i;
            angle +=
                h / 6.0 *
                (recipe.speed_deg_s(a) + 4.0 * recipe.speed_deg_s(a + h / 2) + recipe.speed_deg_s(a + h));
        }
        last = t;
        double torque = recipe.offset_nm + recipe.noise_nm * noise();
        for (const Ripple& r : recipe.ripple) {
            torque += r.amplitude_nm * std::cos(r.order_output * angle / degrees_per_radian + r.phase_rad);
        }
        for (const Tone& tone : recipe.tones) {
            torque += tone.amplitude_nm * std::cos(2.0 * std::numbers::pi * tone.hz * t + tone.phase_rad);
        }
        trace.time_s.push_back(t);
        trace.velocity_deg_s.push_back(recipe.speed_deg_s(t));
        trace.torque_nm.push_back(torque);
        if (recipe.position) trace.position_deg.push_back(angle);
    }
    return trace;
}

}  // namespace ripplenotch::tests
