// SPDX-License-Identifier: MIT
#pragma once
// Logs made in memory for the tests of the analysis room: a motion, ripple by order, tones, noise. What makes
// them is compiled optimised: thousands of logs are looked at.

#include <cmath>
#include <cstdint>
#include <functional>
#include <numbers>
#include <random>
#include <vector>

#include "ripplenotch/analysis/identification.hpp"
#include "ripplenotch/core/trace.hpp"

// In traces.cpp, optimised: without this the linker may take the copy of a test, which is not.
extern template class std::mersenne_twister_engine<std::uint_fast32_t, 32, 624, 397, 31, 0x9908b0df, 11,
                                                   0xffffffff, 7, 0x9d2c5680, 15, 0xefc60000, 18, 1812433253>;

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
    double operator()();

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

Trace make_trace(const TraceRecipe& recipe);

inline Identification identify_all(const std::vector<Trace>& traces, const IdentifyOptions& options = {}) {
    std::vector<TraceView> views;
    for (const Trace& trace : traces) views.push_back(trace.view());
    return identify(views, options);
}

}  // namespace ripplenotch::tests
