// SPDX-License-Identifier: MIT
#pragma once
// Logs made in memory for the tests of the analysis room: a motion, ripple by order, tones, noise.

#include <cmath>
#include <cstdint>
#include <functional>
#include <numbers>
#include <random>
#include <vector>

#include "ripplenotch/analysis/identification.hpp"
#include "ripplenotch/core/trace.hpp"

namespace ripplenotch::tests {

struct Ripple {
    double order_output = 0.0, amplitude_nm = 0.0, phase_rad = 0.0;
};
struct Tone {
    double hz = 0.0, amplitude_nm = 0.0, phase_rad = 0.0;
};

/// Uniform noise shaped to a normal by the sum of twelve: the same numbers with every standard library.
class Noise {
  public:
    explicit Noise(std::uint32_t seed) : engine_(seed) {}
    double operator()() {
        double sum = -6.0;
        for (int i = 0; i < 12; ++i) sum += static_cast<double>(engine_()) / 4294967296.0;
        return sum;
    }

  private:
    std::mt19937 engine_;
};

struct TraceRecipe {
    double rate_hz = 1000.0;
    double seconds = 5.0;
    std::function<double(double)> speed_deg_s = [](double) { return 0.0; };
    std::vector<Ripple> ripple = {};
    std::vector<Tone> tones = {};
    double offset_nm = 10.0;
    double noise_nm = 0.0;
    double jitter_steps = 0.0;  ///< rms of true sampling jitter, in steps
    bool position = true;
    std::uint32_t seed = 1;
};

inline Trace make_trace(const TraceRecipe& recipe) {
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

inline Identification identify_all(const std::vector<Trace>& traces, const IdentifyOptions& options = {}) {
    std::vector<TraceView> views;
    for (const Trace& trace : traces) views.push_back(trace.view());
    return identify(views, options);
}

}  // namespace ripplenotch::tests
