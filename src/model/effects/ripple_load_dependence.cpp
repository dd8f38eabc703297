// SPDX-License-Identifier: MIT
#include <cmath>

#include "model/effects.hpp"

namespace ripplenotch {
namespace {

constexpr Parameter parameters[] = {
    {.name = "gain_percent_per_nm",
     .unit = "%/Nm",
     .help = "by which the ripple grows with each newton-metre of load",
     .start = 5.0,
     .lower = -1000.0,
     .upper = 1e4,
     .linear = true},
    ripple_order_parameter,
};

constexpr LookAlike look_alikes[] = {
    {"ripple-speed-dependence", "the log is one smooth stroke",
     "the same speed with and without acceleration"},
    {"load-friction", "the ripple is faster than the sample rate shows", "a slower move"},
};

void change_ripple(const Situation& situation, Order order, std::span<const double> values,
                   std::span<std::complex<double>> gain) {
    if (!concerns(order, values[1])) return;
    for (std::size_t k = 0; k < gain.size(); ++k)
        gain[k] *= 1.0 + 0.01 * values[0] * std::abs(situation.load_nm[k]);
}

}  // namespace

const Effect effects::ripple_load_dependence{
    .name = "ripple-load-dependence",
    .summary = "ripple whose size grows with the torque that the gear carries",
    .equation =
        "ripple amplitude * (1 + gain_percent_per_nm / 100 * |load| / 1 Nm), load = torque of inertia and "
        "gravity",
    .symptom = "lines of the ripple in the residual where the joint accelerates or holds a weight",
    .look_alikes = look_alikes,
    .source = "Taghirad and Belanger, 1998; Kim, Kim, Song, Trans. KSME A, 2011, who leave it out",
    .side = Side::ripple,
    .domain = Domain::order,
    .parameters = parameters,
    .uses_load = true,
    .change_ripple = change_ripple,
};

}  // namespace ripplenotch
