// SPDX-License-Identifier: MIT
#include "filter/method.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <iterator>

#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/spec.hpp"
#include "ripplenotch/filter/method.hpp"

namespace ripplenotch {

namespace {

constexpr const Method* list[] = {
#define METHOD(name) &filter_methods::name,
#include "filter/methods/methods.def"
#undef METHOD
};

}  // namespace

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

std::span<const Method* const> methods() { return {list, std::size(list)}; }

const Method& find_method(std::string_view name) { return find_entry(methods(), "method", "methods", name); }

}  // namespace ripplenotch
