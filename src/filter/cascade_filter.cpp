// SPDX-License-Identifier: MIT
#include "filter/cascade_filter.hpp"

#include <algorithm>

namespace ripplenotch {

void run_cascade(std::span<const Biquad> sections, std::span<BiquadState> states, std::span<const double> in,
                 double origin, std::span<double> out) {
    run_cascade(sections, states, in, origin, out,
                [](const Biquad& f, BiquadState& s, double x) { return step(f, s, x); });
}

void CascadeFilter::process(const Samples& in, std::span<double> out) {
    if (out.empty()) return;
    if (!started_) {
        origin_nm_ = in.torque_nm.front();
        std::fill(states_.begin(), states_.end(), BiquadState{});
        started_ = true;
    }
    run_cascade(cascade_, states_, in.torque_nm, origin_nm_, out);
}

}  // namespace ripplenotch
