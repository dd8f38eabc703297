// SPDX-License-Identifier: MIT
#pragma once
// All candidates kept warm on the same input, several at a time in vector lanes.

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "filter/kernels/bank_sections.hpp"
#include "filter/kernels/block_sections.hpp"
#include "filter/ripple/ripple_kalman.hpp"
#include "filter/run/engine.hpp"
#include "ripplenotch/filter/method.hpp"

namespace ripplenotch {

// One cascade of unity DC gain that runs for the whole log; shared by the methods that have just one.

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

// Settled gains of the ripple's Kalman filter over motor speed, computed once.

/// Gains in the frame of ripple_rotation, linear between eight speeds an octave.
class GainSchedule {
  public:
    explicit GainSchedule(const RippleModel& model);

    /// The gain at `step_turns` motor turns a sample, either direction, into `gain` (RippleModel::states
    /// entries). At standstill the ripple's is 0 and the torque's that of a filter without ripple.
    void at(double step_turns, std::span<double> gain) const noexcept;

  private:
    std::size_t states_;
    std::vector<double> standing_;
    std::vector<double> gains_;  ///< states_ entries a speed, slowest first
};

/// The result of GainSchedule::at where only one speed is needed: of the hundred or so gains that a schedule
/// holds, only the two at neighbouring speeds are computed.
[[nodiscard]] std::vector<double> scheduled_gain(const RippleModel& model, double step_turns);

/// Lanes do the same additions and multiplications as one candidate alone would, so results do not depend on
/// how many candidates there are, nor on the width of the machine's vectors.
class FilterBank {
  public:
    explicit FilterBank(const Candidates& candidates);

    /// Every candidate settled at a constant input.
    void start(double torque_nm);
    /// The next samples, at most capacity() of them, through every candidate.
    void run(std::span<const double> torque_nm);
    /// Output of a candidate at a sample of the latest run().
    [[nodiscard]] double output(int candidate, std::size_t sample) const noexcept {
        const auto filter = static_cast<std::size_t>(candidate);
        return origin_nm_ + outputs_[filter / lanes * stride + sample].lanes[filter % lanes];
    }
    /// The same for all samples of the latest run(), which is given again for no_candidate, where it passes.
    void outputs(int candidate, std::span<const double> torque_nm, std::span<double> out) const noexcept;
    [[nodiscard]] static constexpr std::size_t capacity() { return most_samples; }

  private:
    static constexpr std::size_t lanes = 4, most_samples = 128;  ///< chosen, not derived
    /// Not a multiple of 4096 bytes: groups would be in one another's way in the first cache, a sixth of the
    /// speed.
    static constexpr std::size_t stride = most_samples + 2;

    std::size_t groups_;
    std::vector<BankSection> sections_;
    std::vector<BankOutput> outputs_;  ///< by group and sample
    double origin_nm_ = 0.0;
    bool mirrored_ = true;
};

}  // namespace ripplenotch
