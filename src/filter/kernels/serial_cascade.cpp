// SPDX-License-Identifier: MIT
#include "filter/kernels/serial_cascade.hpp"

#include "filter/kernels/in_series.hpp"

namespace ripplenotch {

void run_serial(std::span<const Biquad> sections, std::span<BiquadState> states, std::span<const double> in,
                double origin, std::span<double> out) {
    run_in_series(sections, states, in, origin, out,
                  [](const Biquad& f, BiquadState& s, double x) { return step(f, s, x); });
}

}  // namespace ripplenotch
