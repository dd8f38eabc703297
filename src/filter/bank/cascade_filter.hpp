// SPDX-License-Identifier: MIT
#pragma once
// One cascade of unity DC gain that runs for the whole log; shared by the methods that have just one.

#include <optional>
#include <string>
#include <vector>

#include "filter/kernels/block_cascade.hpp"
#include "ripplenotch/filter/method.hpp"

namespace ripplenotch {

/// Runs relative to the first sample of each run: out = x0 + F(x - x0) from zero state. As F has unity gain
/// at 0 Hz this is the steady-state start of F, and a constant torque passes bit for bit, which settled
/// states give only to rounding.
class CascadeFilter final : public CausalFilter {
  public:
    explicit CascadeFilter(Cascade cascade);
    void process(const Samples& in, std::span<double> out) override;
    void restart() override { started_ = false; }
    std::string hurry() override;

  private:
    Cascade cascade_;
    std::vector<BiquadState> states_;
    std::optional<BlockCascade> blocks_;
    double origin_nm_ = 0.0;
    bool started_ = false;
};

}  // namespace ripplenotch
