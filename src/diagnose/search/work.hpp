// SPDX-License-Identifier: MIT
#pragma once
// What a search may cost, counted and not timed, so that the same log ends at the same place everywhere.

#include <cstddef>

namespace ripplenotch {

/// How often effects were run along a motion; the unit is unit_samples.
class Work {
  public:
    explicit Work(double most) : most_(most) {}

    /// Samples that one evaluation runs along.
    static constexpr double unit_samples = 40'000.0;

    void add(std::size_t applied, std::size_t samples) {
        spent_ += static_cast<double>(applied) * static_cast<double>(samples) / unit_samples;
    }
    [[nodiscard]] double spent() const { return spent_; }
    /// Whether a search has to end here; remembered.
    [[nodiscard]] bool is_over() { return ended_ = ended_ || spent_ > most_; }
    [[nodiscard]] bool ended() const { return ended_; }

  private:
    double most_, spent_ = 0.0;
    bool ended_ = false;
};

}  // namespace ripplenotch
