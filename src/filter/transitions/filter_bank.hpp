// SPDX-License-Identifier: MIT
#pragma once
// All candidates kept warm on the same input, several at a time in vector lanes.

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "filter/transitions/transition.hpp"

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
        const auto lane = static_cast<std::size_t>(candidate);
        return origin_nm_ + outputs_[lane / lanes][sample][lane % lanes];
    }
    [[nodiscard]] static constexpr std::size_t capacity() { return 128; }

  private:
    static constexpr std::size_t lanes = 4;
    using Lanes = std::array<double, lanes>;
    struct Section {
        Lanes b0, b1, b2, a1, a2;
        Lanes s1, s2;
    };
    using Group = std::vector<Section>;  ///< sections in series, each of `lanes` candidates

    std::vector<Group> groups_;
    std::vector<std::array<Lanes, 128>> outputs_;
    double origin_nm_ = 0.0;
};

}  // namespace ripplenotch
