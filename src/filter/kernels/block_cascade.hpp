// SPDX-License-Identifier: MIT
#pragma once
// A cascade in block form on a stream that comes in pieces of any length.

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "filter/kernels/block_groups.hpp"

namespace ripplenotch {

/// Groups of samples are counted from the start of the run, not of the piece, and an output is the same sum
/// whether or not its group is complete yet: so the bits do not depend on the pieces.
class BlockCascade {
  public:
    /// One section at least.
    explicit BlockCascade(std::span<const Biquad> sections);

    /// Settled at a constant input; sections have unity gain at 0 Hz.
    void start(double origin);
    /// The next samples; sizes are equal, and the spans may not overlap.
    void run(std::span<const double> in, std::span<double> out);

  private:
    static constexpr std::size_t group = BlockForm::samples;
    bool run_whole(std::span<const double> in, std::span<double> out, bool whatever = false);
    void run_group_by_output(std::span<double> out, std::size_t from, std::size_t to);

    std::vector<BlockPass> passes_;
    std::vector<BlockForm::Memory> before_;  ///< memories to go back to
    std::array<double, group> inputs_{};     ///< of the group that is not complete
    std::size_t known_ = 0;                  ///< how many of them
    double origin_ = 0.0;
};

}  // namespace ripplenotch
