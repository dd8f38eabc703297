// SPDX-License-Identifier: MIT
#include "filter/kernels/block_difference.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "filter/kernels/block_cascade.hpp"
#include "filter/kernels/serial_cascade.hpp"

namespace ripplenotch {
namespace {

constexpr double largest_radius = 0.999;          // by hand
constexpr double time_constants = 40.0;           // until nothing is left of what was before
constexpr int steps = 24, turns = 4, noises = 4;  // by hand: what is tried

// Not std::uniform_real_distribution, which may differ between libraries: a filter must be chosen alike
// everywhere.
double between_minus_one_and_one(std::mt19937_64& engine) {
    return static_cast<double>(static_cast<std::int64_t>(engine() >> 11)) * 0x1p-52 - 1.0;
}

/// Both ways side by side.
class Trial {
  public:
    explicit Trial(std::span<const Biquad> sections)
        : sections_(sections), states_(sections.size()), blocks_(sections) {
        blocks_.start(0.0);
    }

    void hear(std::span<const double> signal) {
        serial_.resize(signal.size());
        run_serial(sections_, states_, signal, 0.0, serial_);
        in_blocks_.resize(signal.size());
        blocks_.run(signal, in_blocks_);
        for (std::size_t k = 0; k < signal.size(); ++k)
            largest_ = std::max(largest_, std::abs(serial_[k] - in_blocks_[k]));
    }

    [[nodiscard]] double largest() const { return largest_; }

  private:
    std::span<const Biquad> sections_;
    std::vector<BiquadState> states_;
    BlockCascade blocks_;
    std::vector<double> serial_, in_blocks_;
    double largest_ = 0.0;
};

/// The signs of the impulse response backward in time, so that all of it adds up at the last sample.
std::vector<double> turning_signs(std::span<const Biquad> sections, std::size_t length) {
    std::vector<double> response(length);
    response.front() = 1.0;
    std::vector<BiquadState> states(sections.size());
    run_serial(sections, states, response, 0.0, response);
    for (double& value : response) value = std::copysign(1.0, value);
    std::reverse(response.begin(), response.end());
    return response;
}

}  // namespace

double trial_difference(std::span<const Biquad> sections) {
    const double radius = pole_radius(sections);
    if (!(radius <= largest_radius)) return std::numeric_limits<double>::infinity();
    std::vector<double> signal(static_cast<std::size_t>(time_constants / (1.0 - radius)));
    std::mt19937_64 engine(1);
    Trial trial(sections);
    for (int i = 0; i < steps; ++i) {
        std::fill(signal.begin(), signal.end(), between_minus_one_and_one(engine));
        trial.hear(signal);
    }
    std::vector<double> signs = turning_signs(sections, signal.size());
    for (int i = 0; i < turns; ++i) {
        trial.hear(signs);
        for (double& value : signs) value = -value;
    }
    for (int i = 0; i < noises; ++i) {
        for (double& value : signal) value = between_minus_one_and_one(engine);
        trial.hear(signal);
    }
    // Filters run relative to the first sample of a log, so they may meet twice its largest torque.
    return 2.0 * trial.largest();
}

bool block_form_serves(std::span<const Biquad> sections) {
    return !sections.empty() && trial_reserve * trial_difference(sections) <= most_block_difference;
}

}  // namespace ripplenotch
