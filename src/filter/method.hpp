// SPDX-License-Identifier: MIT
#pragma once
#include <utility>
#include <vector>

#include "ripplenotch/core/biquad.hpp"
#include "ripplenotch/filter/method.hpp"

namespace ripplenotch {

/// A cascade of unity gain at 0 Hz, which runs relative to the first sample of each run: out = x0 + F(x - x0)
/// from zero state. This is the steady-state start of F, and a constant torque passes bit for bit, which
/// settled states give only to rounding.
class CascadeFilter final : public CausalFilter {
  public:
    explicit CascadeFilter(Cascade cascade) : cascade_(std::move(cascade)), states_(cascade_.size()) {}
    void process(const Samples& in, std::span<double> out) override;
    void restart() override { started_ = false; }

  private:
    Cascade cascade_;
    std::vector<BiquadState> states_;
    double origin_nm_ = 0.0;
    bool started_ = false;
};

namespace filter_methods {

#define METHOD(name) extern const Method name;
#include "filter/methods/methods.def"
#undef METHOD

}  // namespace filter_methods
}  // namespace ripplenotch
