// SPDX-License-Identifier: MIT
#include "filter/cascade_filter.hpp"

#include <algorithm>
#include <utility>

namespace ripplenotch {

CascadeFilter::CascadeFilter(Cascade cascade) : cascade_(std::move(cascade)), states_(cascade_.size()) {}

void CascadeFilter::process(const Samples& in, std::span<double> out) {
    if (out.empty()) return;
    if (!started_) {
        origin_nm_ = in.torque_nm.front();
        std::fill(states_.begin(), states_.end(), BiquadState{});
        started_ = true;
    }
    const double origin = origin_nm_;
    for (std::size_t k = 0; k < out.size(); ++k) out[k] = in.torque_nm[k] - origin;
    for (std::size_t i = 0; i < cascade_.size(); ++i) {
        const Biquad section = cascade_[i];
        BiquadState state = states_[i];
        for (double& value : out) value = step(section, state, value);
        states_[i] = state;
    }
    for (double& value : out) value += origin;
}

}  // namespace ripplenotch
