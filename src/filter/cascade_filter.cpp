// SPDX-License-Identifier: MIT
#include "filter/cascade_filter.hpp"

#include <algorithm>

namespace ripplenotch {

void CascadeFilter::process(const Samples& in, std::span<double> out) {
    if (out.empty()) return;
    if (!started_) {
        origin_nm_ = in.torque_nm.front();
        std::fill(states_.begin(), states_.end(), BiquadState{});
        started_ = true;
    }
    for (std::size_t k = 0; k < out.size(); ++k) {
        double signal = in.torque_nm[k] - origin_nm_;
        for (std::size_t i = 0; i < cascade_.size(); ++i) signal = step(cascade_[i], states_[i], signal);
        out[k] = origin_nm_ + signal;
    }
}

}  // namespace ripplenotch
