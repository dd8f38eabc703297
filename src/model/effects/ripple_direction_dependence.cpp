// SPDX-License-Identifier: MIT
#include <vector>

#include "core/functions/many_numbers.hpp"
#include "model/effects.hpp"
#include "model/evaluate.hpp"

namespace ripplenotch {
namespace {

constexpr Parameter parameters[] = {
    {.name = "gain_percent",
     .unit = "%",
     .help = "by which the ripple is larger in positive direction, and smaller in negative, than their mean",
     .start = 20.0,
     .lower = -1000.0,
     .upper = 1000.0,
     .linear = true},
    {.name = "phase_deg",
     .unit = "deg",
     .help = "by which the ripple is ahead in positive direction, and behind in negative",
     .start = 0.0,
     .lower = -90.0,
     .upper = 90.0},
    width_parameter,
    ripple_order_parameter,
};

constexpr LookAlike look_alikes[] = {
    {"delay", "there is one speed in each direction",
     "two speeds in the same direction: the phase of a delay grows with the speed"},
    {"gear-ratio", "the log is one stroke each way", "several strokes"},
};

void change_ripple(const Situation& situation, Order order, std::span<const double> values,
                   std::span<std::complex<double>> gain) {
    if (!concerns(order, values[3])) return;
    if (values[0] == 0.0 && values[1] == 0.0) return;
    std::vector<double> direction(gain.size());
    const auto& velocity_deg_s = situation.motion.velocity_deg_s;
    with_values(
        gain.size(), [&](std::size_t k) { return velocity_deg_s[k] / values[2]; }, portable::many_tanh,
        [&](std::size_t k, double step) { direction[k] = step; });
    with_cosines_and_sines(
        gain.size(), [&](std::size_t k) { return values[1] * direction[k]; },
        [&](std::size_t k, double of_turn, double sine_of_turn) {
            const double size = 1.0 + 0.01 * values[0] * direction[k];
            const auto before = gain[k];
            const double cosine = size * of_turn, sine = size * sine_of_turn;
            gain[k] = {before.real() * cosine - before.imag() * sine,
                       before.real() * sine + before.imag() * cosine};
        });
}

}  // namespace

const Effect effects::ripple_direction_dependence{
    .name = "ripple-direction-dependence",
    .summary = "ripple that differs with the direction, because other flanks of the teeth carry",
    .equation =
        "ripple amplitude * (1 + gain_percent / 100 * d), ripple phase + phase_deg * d, d = tanh(v / "
        "width_deg_s)",
    .symptom = "lines of the ripple in the residual of opposite sign in the two directions",
    .look_alikes = look_alikes,
    .source = "change of flank in gearing; measured harmonic drives",
    .side = Side::ripple,
    .domain = Domain::order,
    .parameters = parameters,
    .change_ripple = change_ripple,
};

}  // namespace ripplenotch
