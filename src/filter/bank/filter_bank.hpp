// SPDX-License-Identifier: MIT
#pragma once
// All candidates kept warm on the same input, several at a time in vector lanes.

#include <cstddef>
#include <span>
#include <vector>

#include "filter/kernels/bank_sections.hpp"
#include "filter/run/transition.hpp"

namespace ripplenotch {

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
    static constexpr std::size_t lanes = 4, most_samples = 128;  ///< by hand
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
